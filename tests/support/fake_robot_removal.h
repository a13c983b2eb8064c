#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "storage/robot_removal.h"

namespace uplink::testing {

/// Silent robots, as the test says, and which of them were removed; it has no rows. For one thread.
class FakeRobotRemoval final : public storage::RobotRemoval {
 public:
  absl::StatusOr<std::optional<storage::RobotHold>> HoldOf(std::string_view /*ruri*/) override {
    return std::nullopt;
  }
  absl::StatusOr<std::vector<storage::TableCount>> Count(std::string_view /*ruri*/) override {
    return std::vector<storage::TableCount>();
  }
  absl::StatusOr<std::vector<storage::SilentRobot>> SilentSince(SystemTime until,
                                                                const storage::ProcessId& /*self*/,
                                                                std::string_view after) override {
    ++silent_asked;
    if (!status.ok()) return status;
    silent_until = until;
    std::vector<storage::SilentRobot> some;
    for (const auto& [ruri, epoch] : silent) {
      if (ruri > after && some.size() < storage::kSilentRobotsMax) some.push_back({ruri, epoch});
    }
    return some;
  }
  absl::StatusOr<std::optional<storage::EntryBound>> Remove(std::string_view ruri,
                                                            storage::Epoch epoch) override {
    if (!status.ok()) return status;
    if (!remove_status.ok()) return remove_status;
    silent.erase(std::string(ruri));
    removed[std::string(ruri)] = epoch;
    return storage::EntryBound{0};
  }
  absl::StatusOr<std::size_t> RemoveHistories(std::string_view /*ruri*/,
                                              storage::EntryBound /*below*/) override {
    return 0;
  }

  /// Their epochs, until they are removed.
  std::map<std::string, storage::Epoch> silent;
  int silent_asked = 0;
  std::optional<SystemTime> silent_until;
  /// The epoch by which each was removed.
  std::map<std::string, storage::Epoch> removed;
  /// Of SilentSince and Remove.
  absl::Status status;
  /// Of Remove alone.
  absl::Status remove_status;
};

}  // namespace uplink::testing
