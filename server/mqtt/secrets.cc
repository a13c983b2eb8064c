#include "server/mqtt/secrets.h"

#include <utility>

#include <fmt/core.h>

#include "schema/base/file_text.h"
#include "server/config/file_modes.h"
#include "server/identity/authorities.h"
#include "server/identity/expiry.h"
#include "server/identity/pem_file.h"
#include "server/identity/server_pair.h"
#include "server/mqtt/limits.h"

namespace uplink::mqtt {
namespace {

constexpr std::string_view kAuthorityKey = "ca_file";
constexpr std::string_view kCertificateKey = "client_certificate_file";
constexpr std::string_view kKeyKey = "client_key_file";

absl::Status Invalid(std::string_view key, std::string_view text) {
  return absl::FailedPreconditionError(fmt::format("mqtt.{}: {}", key, text));
}

absl::Status InvalidUnlessOk(std::string_view key, const absl::Status& status) {
  return status.ok() ? status : Invalid(key, std::string(status.message()));
}

/// Empty if no file is named.
absl::StatusOr<std::optional<identity::NamedPem>> ReadPemOf(std::string_view key,
                                                            const std::string& path) {
  if (path.empty()) return std::nullopt;
  auto pem = identity::ReadPem(path);
  if (!pem.ok()) return InvalidUnlessOk(key, pem.status());
  if (absl::Status good = config::CheckWriters(path); !good.ok()) {
    return InvalidUnlessOk(key, good);
  }
  return *std::move(pem);
}

/// The check of ValidateFiles (config/files.cc) at a start: files that a start refuses are not used
/// to connect either.
absl::Status CheckTexts(const std::optional<identity::NamedPem>& ca,
                        const std::optional<identity::NamedPem>& certificate,
                        const std::optional<identity::NamedPem>& key) {
  if (ca) {
    absl::Status good = InvalidUnlessOk(kAuthorityKey, identity::CheckAuthorities(*ca));
    if (!good.ok()) return good;
  }
  if (certificate) {
    absl::Status good = InvalidUnlessOk(kCertificateKey, identity::CheckCertificates(*certificate));
    if (!good.ok()) return good;
  }
  if (!certificate || !key) return absl::OkStatus();
  return InvalidUnlessOk(kKeyKey, identity::CheckClientPair(*certificate, *key));
}

std::string TextOf(std::optional<identity::NamedPem> pem) {
  return pem ? std::move(pem->text) : std::string();
}

absl::StatusOr<std::string> ReadPassword(const std::string& path) {
  constexpr std::string_view kKey = "password_file";
  FileText file = ReadFileText(path, kPasswordBytesMax);
  if (!file.problem.empty()) return Invalid(kKey, fmt::format("{}: {}", path, file.problem));
  std::string text = std::move(file.text);
  if (text.ends_with('\n')) text.pop_back();
  if (text.ends_with('\r')) text.pop_back();
  if (text.empty()) return Invalid(kKey, fmt::format("{} is empty", path));
  if (absl::Status good = config::CheckWriters(path); !good.ok()) {
    return Invalid(kKey, std::string(good.message()));
  }
  return text;
}

}  // namespace

absl::StatusOr<Secrets> ReadSecrets(const ClientSettings& settings) {
  Secrets secrets;
  if (!settings.password_file.empty()) {
    auto password = ReadPassword(settings.password_file);
    if (!password.ok()) return password.status();
    secrets.password = *std::move(password);
  }
  auto ca = ReadPemOf(kAuthorityKey, settings.ca_file);
  if (!ca.ok()) return ca.status();
  auto certificate = ReadPemOf(kCertificateKey, settings.certificate_file);
  if (!certificate.ok()) return certificate.status();
  auto key = ReadPemOf(kKeyKey, settings.key_file);
  if (!key.ok()) return key.status();
  if (absl::Status good = CheckTexts(*ca, *certificate, *key); !good.ok()) return good;
  secrets.tls = {TextOf(*std::move(ca)), TextOf(*std::move(certificate)), TextOf(*std::move(key))};
  return secrets;
}

absl::StatusOr<std::optional<SystemTime>> CertificateExpiry(const ClientSettings& settings) {
  const auto certificate = ReadPemOf(kCertificateKey, settings.certificate_file);
  if (!certificate.ok()) return certificate.status();
  if (!*certificate) return std::nullopt;
  const auto expiry = identity::ExpiryOf(**certificate);
  if (!expiry.ok()) return InvalidUnlessOk(kCertificateKey, expiry.status());
  return *expiry;
}

}  // namespace uplink::mqtt
