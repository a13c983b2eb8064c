#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "storage/bounds.h"

namespace uplink::journal {

/// Rows of a robot that go to quarantine between two looks: at most so many may exceed its bound
/// unnoticed.
inline constexpr std::size_t kQuarantineRowsPerLook = storage::kQuarantineRowsPerRobotMax / 10;
/// Robots whose rows are counted. Past it, counting begins anew, and each is checked once more.
inline constexpr std::size_t kQuarantineRobotsMax = 32'768;

/// Robots whose rows went to quarantine, and whose number of rows must be checked: after the first
/// row that this process wrote of a robot, and after every further kQuarantineRowsPerLook. Confined
/// to the writer.
class QuarantineNotes final {
 public:
  explicit QuarantineNotes(std::size_t robots_max = kQuarantineRobotsMax)
      : robots_max_(robots_max) {}

  /// A row of the robot went to quarantine.
  void Note(const std::string& ruri);
  /// There are robots to check.
  [[nodiscard]] bool any() const { return !due_.empty(); }
  /// The first `robots` of them, by RURI.
  [[nodiscard]] std::vector<std::string> First(std::size_t robots) const;
  /// The robot was checked.
  void Done(const std::string& ruri) { due_.erase(ruri); }

 private:
  const std::size_t robots_max_;
  /// Rows since the last check began.
  std::unordered_map<std::string, std::size_t> rows_;
  std::set<std::string> due_;
};

}  // namespace uplink::journal
