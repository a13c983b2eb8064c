#include "server/config/file_modes.h"

#include <optional>
#include <string>

#include <fmt/core.h>
#include <sys/stat.h>

namespace uplink::config {
namespace {

/// Nothing if there is no such file.
std::optional<mode_t> ModeOf(const std::string& path) {
  struct stat status {};
  if (path.empty() || ::stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) {
    return std::nullopt;
  }
  return status.st_mode & 07777U;
}

/// Whether everybody may write the file; `less` is what chmod is told to take away.
absl::Status Writers(const std::string& path, const char* less) {
  const std::optional<mode_t> mode = ModeOf(path);
  if (!mode || (*mode & S_IWOTH) == 0) return absl::OkStatus();
  return absl::FailedPreconditionError(
      fmt::format("everybody on this machine may write {} (mode {:04o}); take that away: "
                  "chmod {} {}",
                  path, *mode, less, path));
}

void CheckTrusted(const std::string& key, const std::string& path, FileModes& modes) {
  const absl::Status writers = CheckWriters(path);
  if (!writers.ok()) modes.problems.push_back({path, key, std::string(writers.message())});
}

void CheckSecret(const std::string& key, const std::string& path, FileModes& modes) {
  const absl::Status writers = Writers(path, "o-rw");
  if (!writers.ok()) {
    modes.problems.push_back({path, key, std::string(writers.message())});
    return;
  }
  const mode_t mode = ModeOf(path).value_or(0);
  if ((mode & S_IROTH) != 0) {
    modes.notes.push_back({{path, key,
                            fmt::format("everybody on this machine may read {} (mode {:04o}); the "
                                        "server's user is enough: chmod o-r {}",
                                        path, mode, path)},
                           "secret_readable"});
  }
  if ((mode & S_IWGRP) != 0) {
    modes.notes.push_back(
        {{path, key,
          fmt::format("the file's group may write {} (mode {:04o}); take that away: chmod g-w {}",
                      path, mode, path)},
         "secret_writable"});
  }
}

}  // namespace

absl::Status CheckWriters(const std::string& path) { return Writers(path, "o-w"); }

FileModes CheckFileModes(const Config& config) {
  FileModes modes;
  const TlsConfig& tls = config.tls;
  CheckTrusted("tls.certificate_file", tls.certificate_file, modes);
  CheckSecret("tls.key_file", tls.key_file, modes);
  CheckTrusted("tls.client_ca_file", tls.client_ca_file, modes);
  CheckTrusted("tls.operator_ca_file", tls.operator_ca_file, modes);
  CheckTrusted("tls.client_crl_file", tls.client_crl_file, modes);
  CheckTrusted("tls.operator_crl_file", tls.operator_crl_file, modes);
  const HttpConfig& http = config.http;
  CheckTrusted("http.tls.certificate_file", http.tls_certificate_file, modes);
  CheckSecret("http.tls.key_file", http.tls_key_file, modes);
  CheckSecret("http.tokens_file", http.tokens_file, modes);
  CheckSecret("http.metrics_token_file", http.metrics_token_file, modes);
  if (IsPostgres(config.store)) {
    CheckSecret("store.password_file", config.store.password_file, modes);
  }
  if (!config.mqtt.url.empty()) {
    CheckTrusted("mqtt.ca_file", config.mqtt.ca_file, modes);
    CheckTrusted("mqtt.client_certificate_file", config.mqtt.client_certificate_file, modes);
    CheckSecret("mqtt.password_file", config.mqtt.password_file, modes);
    CheckSecret("mqtt.client_key_file", config.mqtt.client_key_file, modes);
  }
  return modes;
}

}  // namespace uplink::config
