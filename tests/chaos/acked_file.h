#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/model/ids.h"

namespace uplink::chaos {

/// What the robots were told is durable, in a file that outlives them: a line `robot through_seq`
/// an Ack, written before the robot forgets anything. The last line of a robot counts.
///
/// Thread: thread-safe.
class AckedFile final {
 public:
  /// Reads what earlier lives wrote. Errors: a file that cannot be opened.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<AckedFile>> Open(const std::string& path);
  ~AckedFile();
  AckedFile(const AckedFile&) = delete;
  AckedFile& operator=(const AckedFile&) = delete;

  /// As it was found; 0 for a robot that no line names.
  [[nodiscard]] model::Seq Found(std::uint32_t robot) const;
  [[nodiscard]] absl::Status Write(std::uint32_t robot, model::Seq through);

 private:
  AckedFile(int file, std::map<std::uint32_t, model::Seq> found)
      : file_(file), found_(std::move(found)) {}

  const int file_;
  const std::map<std::uint32_t, model::Seq> found_;
  std::mutex mutex_;
};

}  // namespace uplink::chaos
