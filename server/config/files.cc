// What only the file system can answer about a configuration.
#include <chrono>
#include <filesystem>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

#include <fmt/core.h>

#include "schema/base/file_text.h"
#include "server/config/authority_folder.h"
#include "server/config/file_modes.h"
#include "server/config/load.h"
#include "server/identity/authorities.h"
#include "server/identity/expiry.h"
#include "server/identity/pem_file.h"
#include "server/identity/revocation_list.h"
#include "server/identity/server_pair.h"
#include "server/identity/token_file.h"

namespace uplink::config {
namespace {

/// Bytes that are read of the database's password file.
constexpr std::size_t kTextBytesMax = 1 * kMiB;
constexpr const char* kNoPassword = "is empty; write the password into its first line";

/// What a function says of a file, without its path, which stands before it already.
std::string WithoutPath(const std::string& path, const absl::Status& status) {
  const std::string text(status.message());
  const std::string before = path + ": ";
  return text.starts_with(before) ? text.substr(before.size()) : text;
}

/// The file's text, if `check` finds nothing wrong with it; nothing if no file is named.
std::optional<identity::NamedPem> ReadGood(const std::string& key, const std::string& path,
                                           absl::Status (*check)(const identity::NamedPem&),
                                           std::vector<Problem>& problems) {
  if (path.empty()) return std::nullopt;
  auto pem = identity::ReadPem(path);
  const absl::Status good = pem.ok() ? check(*pem) : pem.status();
  if (good.ok()) return *std::move(pem);
  problems.push_back({path, key, WithoutPath(path, good)});
  return std::nullopt;
}

/// A certificate, its key, and whether both belong together: each by its key of the configuration.
struct Pair {
  std::string certificate_key;
  std::string certificate_file;
  std::string key_key;
  std::string key_file;
  absl::Status (*check)(const identity::NamedPem&, const identity::NamedPem&);
};

void CheckPair(const Pair& pair, std::vector<Problem>& problems) {
  const auto certificate =
      ReadGood(pair.certificate_key, pair.certificate_file, identity::CheckCertificates, problems);
  const auto key = ReadGood(pair.key_key, pair.key_file, identity::CheckKey, problems);
  if (!certificate || !key) return;
  const absl::Status fit = pair.check(*certificate, *key);
  if (fit.ok()) return;
  problems.push_back(
      {pair.certificate_file, pair.certificate_key, WithoutPath(pair.certificate_file, fit)});
}

void CheckAuthorities(const std::string& key, const std::string& path,
                      std::vector<Problem>& problems) {
  static_cast<void>(ReadGood(key, path, identity::CheckAuthorities, problems));
}

void CheckLists(const std::string& key, const std::string& path, const std::string& signers,
                std::vector<Problem>& problems) {
  if (path.empty()) return;
  if (signers.empty()) {
    return problems.push_back({path, key,
                               "needs tls.client_ca_file; the lists of a folder of authorities are "
                               "named there, by crl_file"});
  }
  const auto authorities = identity::ReadPem(signers);
  if (!authorities.ok()) return;  // said of its own key
  const auto file = identity::ReadPem(path);
  const absl::Status good =
      file.ok() ? identity::ReadRevocationLists(*file, *authorities).status() : file.status();
  if (!good.ok()) problems.push_back({path, key, WithoutPath(path, good)});
}

void CheckAuthorityFolder(const IdentityConfig& identity, std::vector<Problem>& problems) {
  const std::string& path = identity.authorities;
  if (path.empty()) return;
  const auto folder = ReadAuthorityFolder(path);
  if (!folder.ok()) {
    return problems.push_back({path, "identity.authorities", WithoutPath(path, folder.status())});
  }
  for (const AuthorityLists& each : folder->lists) {
    const auto authority = identity::ReadPem(each.authority);
    const auto file = identity::ReadPem(each.lists);
    absl::Status good = file.status();
    if (file.ok() && authority.ok()) {
      good = identity::ReadRevocationLists(*file, *authority).status();
    }
    if (!good.ok()) {
      problems.push_back({each.lists, "identity.authorities", WithoutPath(each.lists, good)});
    }
  }
}

void CheckStoreFolder(const StoreConfig& store, std::vector<Problem>& problems) {
  const std::filesystem::path path(SqlitePath(store));
  if (path.empty()) {
    return;
  }
  std::error_code error;
  const std::filesystem::path folder = path.parent_path();
  if (!std::filesystem::is_directory(folder, error)) {
    problems.push_back({path.string(), "store.url",
                        fmt::format("the folder {} does not exist; make it, and let this user "
                                    "write there",
                                    folder.string())});
  } else if (std::filesystem::is_directory(path, error)) {
    problems.push_back({path.string(), "store.url", "is a folder; name the database file in it"});
  }
}

void CheckPasswordFile(const StoreConfig& store, std::vector<Problem>& problems) {
  const std::string& path = store.password_file;
  if (path.empty() || !IsPostgres(store)) return;
  const FileText file = ReadFileText(path, kTextBytesMax);
  std::string flaw = file.problem;
  if (flaw.empty() && file.text.substr(0, file.text.find('\n')).empty()) flaw = kNoPassword;
  if (!flaw.empty()) problems.push_back({path, "store.password_file", std::move(flaw)});
}

void CheckBrokerFiles(const MqttConfig& mqtt, std::vector<Problem>& problems) {
  if (mqtt.url.empty()) return;
  CheckAuthorities("mqtt.ca_file", mqtt.ca_file, problems);
  CheckPair({"mqtt.client_certificate_file", mqtt.client_certificate_file, "mqtt.client_key_file",
             mqtt.client_key_file, identity::CheckClientPair},
            problems);
  const std::string& path = mqtt.password_file;
  if (path.empty()) return;
  const FileText file = ReadFileText(path, kMqttPasswordBytesMax);
  std::string flaw = file.problem;
  const bool line_end_alone = file.text.find_first_not_of("\r\n") == std::string::npos;
  if (flaw.empty() && line_end_alone) flaw = kNoPassword;
  if (!flaw.empty()) problems.push_back({path, "mqtt.password_file", std::move(flaw)});
}

void CheckHttpFiles(const HttpConfig& http, std::vector<Problem>& problems) {
  CheckPair({"http.tls.certificate_file", http.tls_certificate_file, "http.tls.key_file",
             http.tls_key_file, identity::CheckServerPair},
            problems);
  const auto add = [&problems](const std::string& key, const std::string& path,
                               const absl::Status& good) {
    if (!good.ok()) problems.push_back({path, key, WithoutPath(path, good)});
  };
  if (const std::string& path = http.tokens_file; !path.empty()) {
    add("http.tokens_file", path, identity::ReadTokenFile(path).status());
  }
  if (const std::string& path = http.metrics_token_file; !path.empty()) {
    add("http.metrics_token_file", path, identity::ReadScrapeToken(path).status());
  }
}

}  // namespace

std::vector<Problem> ValidateFiles(const Config& config) {
  std::vector<Problem> problems;
  const TlsConfig& tls = config.tls;
  CheckPair({"tls.certificate_file", tls.certificate_file, "tls.key_file", tls.key_file,
             identity::CheckServerPair},
            problems);
  CheckAuthorities("tls.client_ca_file", tls.client_ca_file, problems);
  CheckAuthorities("tls.operator_ca_file", tls.operator_ca_file, problems);
  CheckLists("tls.client_crl_file", tls.client_crl_file, tls.client_ca_file, problems);
  CheckLists("tls.operator_crl_file", tls.operator_crl_file, OperatorCaFile(tls), problems);
  CheckAuthorityFolder(config.identity, problems);
  CheckStoreFolder(config.store, problems);
  CheckPasswordFile(config.store, problems);
  CheckBrokerFiles(config.mqtt, problems);
  CheckHttpFiles(config.http, problems);
  return problems;
}

LoadResult WithFiles(LoadResult result) {
  if (!result.readable) return result;
  std::set<std::string> at_fault;
  for (const Problem& problem : result.problems) at_fault.insert(problem.key);
  // An invalid key holds its default: what that names says nothing about the file.
  const auto add = [&at_fault](auto& to, auto& found) {
    for (auto& each : found) {
      if (!at_fault.contains(each.key)) to.push_back(std::move(each));
    }
  };
  std::vector<Problem> found = ValidateFiles(*result.readable);
  FileModes modes = CheckFileModes(*result.readable);
  add(result.problems, found);
  add(result.problems, modes.problems);
  add(result.notes, modes.notes);
  if (!result.problems.empty()) result.config.reset();
  return result;
}

std::vector<Note> ExpiredFiles(const Config& config, SystemTime now) {
  std::vector<Note> notes;
  const auto check = [&](const std::string& key, const std::string& path) {
    if (path.empty()) return;
    const auto certificate = identity::ReadPem(path);
    if (!certificate.ok()) return;  // ValidateFiles says so
    const auto expiry = identity::ExpiryOf(*certificate);
    if (!expiry.ok() || *expiry > now) return;
    const auto ago = std::chrono::duration_cast<std::chrono::hours>(now - *expiry);
    notes.push_back({{path, key,
                      fmt::format("the certificate expired {} h ago by this machine's clock; "
                                  "replace it",
                                  ago.count())},
                     "certificate_expired"});
  };
  check("tls.certificate_file", config.tls.certificate_file);
  check("http.tls.certificate_file", config.http.tls_certificate_file);
  check("mqtt.client_certificate_file", config.mqtt.client_certificate_file);
  return notes;
}

}  // namespace uplink::config
