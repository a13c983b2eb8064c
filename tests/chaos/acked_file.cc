#include "tests/chaos/acked_file.h"

#include <cerrno>
#include <fstream>
#include <memory>

#include <fcntl.h>
#include <unistd.h>

namespace uplink::chaos {

absl::StatusOr<std::unique_ptr<AckedFile>> AckedFile::Open(const std::string& path) {
  std::map<std::uint32_t, model::Seq> found;
  {
    std::ifstream lines(path);
    std::uint32_t robot = 0;
    model::Seq through = 0;
    while (lines >> robot >> through) found[robot] = through;
  }
  constexpr int kOwnerReadsAndWrites = 0600;
  const int file =
      ::open(path.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, kOwnerReadsAndWrites);
  if (file < 0) return absl::ErrnoToStatus(errno, path);
  return std::unique_ptr<AckedFile>(new AckedFile(file, std::move(found)));
}

AckedFile::~AckedFile() { ::close(file_); }

model::Seq AckedFile::Found(std::uint32_t robot) const {
  const auto line = found_.find(robot);
  return line == found_.end() ? 0 : line->second;
}

absl::Status AckedFile::Write(std::uint32_t robot, model::Seq through) {
  const std::string line = std::to_string(robot) + " " + std::to_string(through) + "\n";
  const std::lock_guard lock(mutex_);
  // One write a line: a kill leaves whole lines.
  const ssize_t written = ::write(file_, line.data(), line.size());
  if (written == static_cast<ssize_t>(line.size())) return absl::OkStatus();
  return absl::ErrnoToStatus(errno, "the file of acks");
}

}  // namespace uplink::chaos
