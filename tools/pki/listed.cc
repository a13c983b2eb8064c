#include "tools/pki/listed.h"

#include <algorithm>
#include <cstdint>
#include <ctime>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/core.h>
#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/x509v3.h>
#include <unistd.h>

#include "server/identity/expiry.h"
#include "server/identity/peer_identity.h"
#include "server/identity/pem.h"
#include "server/identity/server_names.h"
#include "server/identity/shown_certificate.h"

namespace uplink::pki {
namespace {

constexpr const char* kSuffix = ".crt";

std::string IssuerOf(const X509& certificate) {
  const identity::Bio bio(BIO_new(BIO_s_mem()));
  const X509_NAME* const name = X509_get_issuer_name(&certificate);
  if (bio == nullptr || X509_NAME_print_ex(bio.get(), name, 0, XN_FLAG_RFC2253) < 0) return {};
  char* text = nullptr;
  const long size = BIO_get_mem_data(bio.get(), &text);
  return {text, std::min(static_cast<std::size_t>(size), identity::kSubjectBytesMax)};
}

SystemTime BeginOf(const X509& certificate) {
  std::tm utc{};
  if (ASN1_TIME_to_tm(X509_get0_notBefore(&certificate), &utc) != 1) return {};
  return FromUnixMs(std::int64_t{timegm(&utc)} * 1000);
}

void ReadIdentity(X509& certificate, Listed& listed) {
  const absl::StatusOr<identity::PeerIdentity> is = identity::IdentityOf(certificate);
  if (!is.ok()) {
    listed.kind = "unknown";
    listed.why = std::string(is.status().message());
    return;
  }
  listed.kind = std::string(identity::ToText(is->role));
  listed.fleet = is->fleet;
  listed.names = is->gateway.ruris;
  if (!is->ruri.empty()) listed.names = {is->ruri};
}

/// Who may use it for what, as the certificate itself says.
void ReadKind(X509& certificate, const identity::NamedPem& pem, Listed& listed) {
  if (X509_check_ca(&certificate) == 1) {
    listed.kind = "authority";
    return;
  }
  const std::uint32_t use = X509_get_extended_key_usage(&certificate);
  if (use != UINT32_MAX && (use & XKU_SSL_SERVER) != 0) {
    listed.kind = "server";
    if (auto names = identity::ServerNamesOf(pem); names.ok()) listed.names = *std::move(names);
    return;
  }
  ReadIdentity(certificate, listed);
}

}  // namespace

absl::StatusOr<Listed> ReadListed(const Directory& directory, const std::string& name) {
  const std::string path = directory.CertificatePath(name);
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    return absl::NotFoundError(
        fmt::format("{} is not there; uplinkctl pki list --dir {} shows those that are", path,
                    directory.path()));
  }
  const absl::StatusOr<identity::NamedPem> pem = identity::ReadPem(path);
  if (!pem.ok()) return pem.status();
  const auto certificates = identity::ReadCertificates(*pem);
  if (!certificates.ok()) return certificates.status();
  X509& certificate = *certificates->front();
  const storage::CertificateFacts facts = identity::FactsOf(identity::ShownBy(certificate));
  Listed listed;
  listed.name = name;
  listed.subject = identity::SubjectOf(certificate);
  listed.issuer = IssuerOf(certificate);
  listed.serial = facts.serial;
  listed.sha256 = facts.sha256;
  listed.key_sha256 = facts.key_sha256;
  listed.begins = BeginOf(certificate);
  listed.expires = identity::NotAfterOf(certificate);
  listed.has_key = ::access(directory.KeyPath(name).c_str(), F_OK) == 0;
  ReadKind(certificate, *pem, listed);
  ERR_clear_error();
  return listed;
}

absl::StatusOr<std::vector<std::string>> NamesIn(const Directory& directory) {
  std::error_code error;
  std::vector<std::string> names;
  for (std::filesystem::directory_iterator at(directory.path(), error), end; !error && at != end;
       at.increment(error)) {
    const std::filesystem::path file = at->path().filename();
    // What a call left aside begins with a point.
    if (file.extension() == kSuffix && !file.string().starts_with('.')) {
      names.push_back(file.stem().string());
    }
  }
  if (error) {
    return absl::NotFoundError(
        fmt::format("{}: {}; name the folder by --dir", directory.path(), error.message()));
  }
  std::ranges::sort(names);
  return names;
}

}  // namespace uplink::pki
