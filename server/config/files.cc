// What only the file system can answer about a configuration.
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <system_error>

#include <fmt/core.h>
#include <sys/stat.h>

#include "server/config/load.h"

namespace uplink::config {
namespace {

/// Bytes of a PEM file that are searched for its first header.
constexpr std::size_t kPemBytesMax = 1 * kMiB;

/// The file's text, or a sentence about why it cannot be had.
struct FileText {
  std::string text;
  std::string problem;
};

FileText ReadFile(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) {
    const std::error_code error(errno, std::generic_category());
    return {{}, fmt::format("{}: {}", path, error.message())};
  }
  if (!S_ISREG(status.st_mode)) {
    return {{}, fmt::format("{} is not a regular file", path)};
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    return {{}, fmt::format("{} cannot be opened for reading", path)};
  }
  std::string text(kPemBytesMax, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  return {std::move(text), {}};
}

void CheckPem(const std::string& key, const std::string& path, std::string_view what,
              std::vector<Problem>& problems) {
  if (path.empty()) {
    return;
  }
  const FileText file = ReadFile(path);
  if (!file.problem.empty()) {
    problems.push_back({path, key, file.problem});
    return;
  }
  const std::size_t header = file.text.find("-----BEGIN ");
  const std::size_t line_end = file.text.find('\n', header);
  if (header == std::string::npos ||
      std::string_view(file.text).substr(header, line_end - header).find(what) ==
          std::string_view::npos) {
    problems.push_back({path, key, fmt::format("{} holds no PEM {}", path, what)});
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
    problems.push_back(
        {path.string(), "store.url", fmt::format("the folder {} does not exist", folder.string())});
  } else if (std::filesystem::is_directory(path, error)) {
    problems.push_back(
        {path.string(), "store.url", fmt::format("{} is a folder, not a file", path.string())});
  }
}

}  // namespace

std::vector<Problem> ValidateFiles(const Config& config) {
  std::vector<Problem> problems;
  CheckPem("tls.certificate_file", config.tls.certificate_file, "CERTIFICATE", problems);
  CheckPem("tls.key_file", config.tls.key_file, "PRIVATE KEY", problems);
  CheckPem("tls.client_ca_file", config.tls.client_ca_file, "CERTIFICATE", problems);
  CheckPem("tls.operator_ca_file", config.tls.operator_ca_file, "CERTIFICATE", problems);
  CheckStoreFolder(config.store, problems);
  return problems;
}

}  // namespace uplink::config
