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

/// Whether everybody may write the file. One that is not there is another's to report. Links are
/// followed, as Kubernetes has them.
///
/// Errors: kFailedPrecondition with a sentence that names the file, its mode and what to do.
/// Thread: any; asks the file system.
[[nodiscard]] absl::Status CheckWriters(const std::string& path);

/// Looks at the files of the keys that hold a private key or a password, as CheckWriters also at
/// those with certificates.
///
/// Thread: any; asks the file system.
[[nodiscard]] FileModes CheckFileModes(const Config& config);

}  // namespace uplink::config
