#include "server/config/file_modes.h"

#include <string>

#include <fmt/core.h>
#include <sys/stat.h>

namespace uplink::config {
namespace {

void CheckFile(const std::string& key, const std::string& path, FileModes& modes) {
  struct stat status {};
  if (path.empty() || ::stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return;
  const mode_t mode = status.st_mode & 07777U;
  if ((mode & S_IWOTH) != 0) {
    modes.problems.push_back(
        {path, key,
         fmt::format("everybody on this machine may write {} (mode {:04o}); take that away: "
                     "chmod o-rw {}",
                     path, mode, path)});
    return;
  }
  if ((mode & S_IROTH) != 0) {
    modes.notes.push_back({{path, key,
                            fmt::format("everybody on this machine may read {} (mode {:04o}); the "
                                        "server's user is enough",
                                        path, mode)},
                           "secret_readable"});
  }
  if ((mode & S_IWGRP) != 0) {
    modes.notes.push_back(
        {{path, key, fmt::format("the file's group may write {} (mode {:04o})", path, mode)},
         "secret_writable"});
  }
}

}  // namespace

FileModes CheckFileModes(const Config& config) {
  FileModes modes;
  CheckFile("tls.key_file", config.tls.key_file, modes);
  if (IsPostgres(config.store)) {
    CheckFile("store.password_file", config.store.password_file, modes);
  }
  return modes;
}

}  // namespace uplink::config
