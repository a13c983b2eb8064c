#pragma once

#include <string>
#include <vector>

#include <absl/status/status.h>

#include "server/config/load.h"

namespace uplink::config {

/// What the permissions of files allow to others than their owner. A value.
struct FileModes {
  /// Files that everybody may write: anyone on the machine could choose the secret, or whom the
  /// server trusts.
  std::vector<Problem> problems;
  /// Files with secrets that everybody may read, or that the group may write.
  std::vector<Note> notes;
};

/// Fails if everybody may write the file. Other checks report a file that is missing. Links are
/// followed, as Kubernetes mounts files by links.
///
/// Errors: kFailedPrecondition with a sentence that names the file, its mode and what to do.
/// Thread: any; asks the file system.
[[nodiscard]] absl::Status CheckWriters(const std::string& path);

/// Checks the files that the configuration names: those with a private key or a password for both
/// lists, those with certificates as CheckWriters does.
///
/// Thread: any; asks the file system.
[[nodiscard]] FileModes CheckFileModes(const Config& config);

}  // namespace uplink::config
