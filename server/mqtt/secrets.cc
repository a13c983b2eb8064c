#include "server/mqtt/secrets.h"

#include <cerrno>
#include <fstream>
#include <system_error>
#include <utility>

#include <fmt/core.h>

#include "server/config/file_modes.h"
#include "server/identity/server_pair.h"
#include "server/mqtt/limits.h"

namespace uplink::mqtt {
namespace {

constexpr std::string_view kCertificateKey = "client_certificate_file";

absl::Status Invalid(std::string_view key, std::string_view text) {
  return absl::FailedPreconditionError(fmt::format("mqtt.{}: {}", key, text));
}

absl::StatusOr<std::string> ReadPemOf(std::string_view key, const std::string& path) {
  if (path.empty()) return std::string();
  auto pem = identity::ReadPem(path);
  if (!pem.ok()) return Invalid(key, std::string(pem.status().message()));
  if (absl::Status good = config::CheckWriters(path); !good.ok()) {
    return Invalid(key, std::string(good.message()));
  }
  return std::move(pem->text);
}

absl::StatusOr<std::optional<SystemTime>> ExpiryOf(const std::string& certificate) {
  if (certificate.empty()) return std::nullopt;
  const auto expiry = identity::ExpiryOf({"mqtt.client_certificate_file", certificate});
  if (!expiry.ok()) return expiry.status();
  return *expiry;
}

absl::StatusOr<std::string> ReadPassword(const std::string& path) {
  constexpr std::string_view kKey = "password_file";
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::string text(kPasswordBytesMax + 1, '\0');
  if (file) file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad() || !file.is_open()) {
    const std::error_code error(errno, std::generic_category());
    return Invalid(kKey, fmt::format("{}: {}", path, error.message()));
  }
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > kPasswordBytesMax) {
    return Invalid(kKey, fmt::format("{} has over {} bytes", path, kPasswordBytesMax));
  }
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
  auto ca = ReadPemOf("ca_file", settings.ca_file);
  if (!ca.ok()) return ca.status();
  auto certificate = ReadPemOf(kCertificateKey, settings.certificate_file);
  if (!certificate.ok()) return certificate.status();
  auto key = ReadPemOf("client_key_file", settings.key_file);
  if (!key.ok()) return key.status();
  if (const auto expiry = ExpiryOf(*certificate); !expiry.ok()) return expiry.status();
  secrets.tls = {*std::move(ca), *std::move(certificate), *std::move(key)};
  return secrets;
}

absl::StatusOr<std::optional<SystemTime>> CertificateExpiry(const ClientSettings& settings) {
  const auto certificate = ReadPemOf(kCertificateKey, settings.certificate_file);
  if (!certificate.ok()) return certificate.status();
  return ExpiryOf(*certificate);
}

}  // namespace uplink::mqtt
