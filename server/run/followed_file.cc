#include "server/run/followed_file.h"

#include <sys/stat.h>

namespace uplink::run {

FollowedFile::FollowedFile(std::string path) : path_(std::move(path)) { NoteRead(); }

std::optional<FollowedFile::State> FollowedFile::LookNow() const {
  struct stat found {};
  if (::stat(path_.c_str(), &found) != 0) return std::nullopt;
  return State{found.st_ino, found.st_size, found.st_mtim.tv_sec, found.st_mtim.tv_nsec};
}

bool FollowedFile::Look() {
  const std::optional<State> before = std::exchange(seen_, LookNow());
  if (!seen_ || seen_ == known_ || seen_ != before) return false;
  known_ = seen_;
  return true;
}

}  // namespace uplink::run
