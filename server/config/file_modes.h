#pragma once

#include <vector>

#include "server/config/load.h"

namespace uplink::config {

/// What the permissions of files that hold secrets allow to others than their owner. A value.
struct FileModes {
  /// Files that everybody may write: whoever is on the machine chooses the secret.
  std::vector<Problem> problems;
  /// Files that everybody may read, or that the group may write.
  std::vector<Note> notes;
};

/// Looks at the files of the keys that hold a private key or a password. A file that is not there
/// is another's to report. Links are followed, as Kubernetes has them.
///
/// Thread: any; asks the file system.
[[nodiscard]] FileModes CheckFileModes(const Config& config);

}  // namespace uplink::config
