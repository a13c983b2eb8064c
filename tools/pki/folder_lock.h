#pragma once

#include <string>

namespace uplink::pki {

/// Keeps other calls from writing into a folder while it lives, so that none takes the other's file
/// aside for one that was left, and none drops the other's change. A file system without such locks
/// does without. A resource.
///
/// Thread: confined to one; its making blocks while another process holds the lock.
class FolderLock final {
 public:
  explicit FolderLock(const std::string& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  const int fd_;
};

}  // namespace uplink::pki
