#include "tools/pki/kept.h"

#include <algorithm>

#include <absl/strings/match.h>
#include <fmt/format.h>
#include <openssl/err.h>
#include <openssl/x509v3.h>

#include "server/identity/expiry.h"
#include "server/identity/pem.h"
#include "server/identity/server_names.h"
#include "server/identity/server_pair.h"

namespace uplink::pki {
namespace {

using identity::Certificate;
using identity::NamedPem;

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
  for (const std::string& host : hosts) {
    if (!Names(certificate, *names, host)) missing.push_back(host);
  }
  if (missing.empty()) return absl::OkStatus();
  return Unfit(pem.name, fmt::format("is for {}, and not for {}", fmt::join(*names, ", "),
                                     fmt::join(missing, ", ")));
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
  return wanted.hosts.empty() ? absl::OkStatus() : CheckHosts(pem, *certificate, wanted.hosts);
}

}  // namespace uplink::pki
