#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "server/fleet/fleet.h"

namespace uplink::view {

/// The robots of the fleet by RURI, sorted anew only after one entered or left memory. It keeps no
/// robot in memory.
///
/// Limits: one entry per robot of the fleet.
/// Thread: thread-safe.
class SortedRobots final {
 public:
  struct Entry {
    std::weak_ptr<robot::Robot> robot;
    /// As ShortNameOf.
    std::string short_name;
  };
  using List = std::vector<Entry>;

  /// It outlives this.
  explicit SortedRobots(const fleet::Fleet& fleet) : fleet_(fleet) {}

  /// Without stand-ins (storage::IsNoRobot). A robot may have left memory since.
  [[nodiscard]] std::shared_ptr<const List> Get();

 private:
  const fleet::Fleet& fleet_;
  std::mutex mutex_;
  std::shared_ptr<const List> list_;
  std::uint64_t changes_ = 0;
};

}  // namespace uplink::view
