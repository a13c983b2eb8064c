#include "tools/pki/kept.h"

#include <algorithm>
#include <cstddef>
#include <string_view>

#include <absl/strings/match.h>
#include <fmt/format.h>
#include <openssl/err.h>
#include <openssl/x509v3.h>
#include <sys/stat.h>

#include "schema/base/utf8.h"
#include "server/identity/expiry.h"
#include "server/identity/peer_identity.h"
#include "server/identity/pem.h"
#include "server/identity/server_names.h"
#include "server/identity/server_pair.h"

namespace uplink::pki {
namespace {

using identity::Certificate;
using identity::NamedPem;

/// How profiles begin the name of a robot.
constexpr std::string_view kUri = "URI:";
/// How many bytes of a value a sentence repeats.
constexpr std::size_t kShownBytesMax = 256;
constexpr const char* kRemedy = "--force in place of --keep makes a new one";

absl::Status Unfit(const std::string& path, const std::string& what) {
  return absl::FailedPreconditionError(fmt::format("{}: {}; {}", path, what, kRemedy));
}

absl::StatusOr<Certificate> ReadOne(const NamedPem& pem) {
  auto certificates = identity::ReadCertificates(pem);
  if (!certificates.ok()) return certificates.status();
  return std::move(certificates->front());
}

bool Signed(const Certificate& by, const Certificate& what) {
  const bool is = X509_check_issued(by.get(), what.get()) == X509_V_OK &&
                  X509_verify(what.get(), X509_get0_pubkey(by.get())) == 1;
  ERR_clear_error();
  return is;
}

/// As clients look for the host: an address in any spelling, a name in capitals or small letters.
bool Names(const Certificate& certificate, const std::vector<std::string>& names,
           const std::string& host) {
  const auto same = [&host](const std::string& name) { return absl::EqualsIgnoreCase(name, host); };
  const bool is = std::any_of(names.begin(), names.end(), same) ||
                  X509_check_ip_asc(certificate.get(), host.c_str(), 0) == 1 ||
                  X509_check_host(certificate.get(), host.data(), host.size(),
                                  X509_CHECK_FLAG_NEVER_CHECK_SUBJECT, nullptr) == 1;
  ERR_clear_error();
  return is;
}

absl::Status CheckHosts(const NamedPem& pem, const Certificate& certificate,
                        const std::vector<std::string>& hosts) {
  const auto names = identity::ServerNamesOf(pem);
  if (!names.ok()) return names.status();
  std::vector<std::string> missing;
  std::vector<std::string> shown;
  for (const std::string& name : *names) shown.push_back(PrintableUtf8(name, kShownBytesMax));
  for (const std::string& host : hosts) {
    if (!Names(certificate, *names, host)) missing.push_back(host);
  }
  if (missing.empty()) return absl::OkStatus();
  return Unfit(pem.name, fmt::format("is for {}, and not for {}", fmt::join(shown, ", "),
                                     fmt::join(missing, ", ")));
}

/// Empty if the subject has none.
std::string CommonNameOf(const Certificate& certificate) {
  const X509_NAME* const subject = X509_get_subject_name(certificate.get());
  const int at = X509_NAME_get_index_by_NID(subject, NID_commonName, -1);
  if (at < 0) return {};
  unsigned char* bytes = nullptr;
  const int length =
      ASN1_STRING_to_UTF8(&bytes, X509_NAME_ENTRY_get_data(X509_NAME_get_entry(subject, at)));
  ERR_clear_error();
  if (length < 0) return {};
  std::string name(bytes, bytes + length);
  OPENSSL_free(bytes);
  return name;
}

std::vector<std::string> RurisOf(const identity::PeerIdentity& identity) {
  if (identity.role == identity::Role::kRobot) return {identity.ruri};
  return identity.gateway.ruris;
}

std::vector<std::string> RurisOf(const Profile& profile) {
  std::vector<std::string> ruris;
  for (const std::string& name : profile.alternative_names) {
    if (name.starts_with(kUri)) ruris.push_back(name.substr(kUri.size()));
  }
  return ruris;
}

/// In one order, whichever the certificate has.
std::string Joined(std::vector<std::string> ruris) {
  std::sort(ruris.begin(), ruris.end());
  return ruris.empty() ? "none" : fmt::format("{}", fmt::join(ruris, ", "));
}

/// What the relay would read from it, and its name.
absl::Status CheckClient(const std::string& path, const Certificate& certificate,
                         const Profile& wanted) {
  const auto is = identity::IdentityOf(*certificate);
  if (!is.ok()) return Unfit(path, std::string(is.status().message()));
  const std::string& unit = wanted.organizational_unit;
  const struct {
    const char* what;
    std::string is;
    std::string wanted;
  } parts[] = {
      {"role", std::string(identity::ToText(is->role)), unit.empty() ? "robot" : unit},
      {"fleet", is->fleet, wanted.organization},
      {"RURI", Joined(RurisOf(*is)), Joined(RurisOf(wanted))},
      {"name", CommonNameOf(certificate), wanted.common_name},
  };
  std::vector<std::string> differences;
  for (const auto& part : parts) {
    if (part.is == part.wanted) continue;
    differences.push_back(fmt::format("{} {}, and not {}", part.what,
                                      PrintableUtf8(part.is, kShownBytesMax),
                                      PrintableUtf8(part.wanted, kShownBytesMax)));
  }
  if (differences.empty()) return absl::OkStatus();
  return Unfit(path, fmt::format("has the {}", fmt::join(differences, "; the ")));
}

/// Whether it is of the wanted kind and says what is wanted.
absl::Status CheckSaid(const NamedPem& pem, const Certificate& certificate, const Wanted& wanted) {
  if (!wanted.hosts.empty()) return CheckHosts(pem, certificate, wanted.hosts);
  if (wanted.client) return CheckClient(pem.name, certificate, *wanted.client);
  if (wanted.authority_pem.empty() && X509_check_ca(certificate.get()) != 1) {
    return Unfit(pem.name, "is no authority's certificate");
  }
  return absl::OkStatus();
}

absl::Status CheckKeyMode(const std::string& path) {
  struct stat info {};
  if (stat(path.c_str(), &info) != 0 || (info.st_mode & (S_IRWXG | S_IRWXO)) == 0) {
    return absl::OkStatus();  // it was read a moment ago
  }
  return absl::FailedPreconditionError(
      fmt::format("{}: others than its owner may read or write the key (mode {:04o}); if none of "
                  "them did, chmod 600 {}, else {}",
                  path, info.st_mode & 07777U, path, kRemedy));
}

}  // namespace

absl::Status CheckKept(const Directory& directory, const std::string& name, const Wanted& wanted,
                       SystemTime now) {
  const absl::StatusOr<Credentials> kept = directory.Read(name);
  if (!kept.ok()) return kept.status();
  const NamedPem pem{directory.CertificatePath(name), kept->certificate_pem};
  const NamedPem key{directory.KeyPath(name), kept->key_pem};
  absl::Status fits = wanted.hosts.empty() ? identity::CheckClientPair(pem, key)
                                           : identity::CheckServerPair(pem, key);
  if (!fits.ok()) return fits;
  if (absl::Status owned = CheckKeyMode(key.name); !owned.ok()) return owned;
  const auto certificate = ReadOne(pem);
  if (!certificate.ok()) return certificate.status();
  if (!wanted.authority_pem.empty()) {
    const auto authority =
        ReadOne({directory.CertificatePath(kAuthorityName), wanted.authority_pem});
    if (!authority.ok()) return authority.status();
    if (!Signed(*authority, *certificate)) {
      return Unfit(pem.name, fmt::format("was not signed by the authority of {}",
                                         directory.CertificatePath(kAuthorityName)));
    }
  }
  const auto expiry = identity::ExpiryOf(pem);
  if (!expiry.ok()) return expiry.status();
  if (*expiry <= now) {
    return Unfit(pem.name, fmt::format("expired at {}", identity::ExpiryText(*expiry)));
  }
  return CheckSaid(pem, *certificate, wanted);
}

}  // namespace uplink::pki
