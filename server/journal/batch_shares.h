#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>

#include "server/journal/entry.h"
#include "server/journal/gateway_use.h"
#include "server/journal/limits.h"

namespace uplink::journal {

/// Shares a batch among the robots whose entries wait, and among gateways. A robot's entries keep
/// their order: once one is left for a later batch, so are all behind it. A robot or gateway with
/// nothing in the batch may always add one entry, of any size.
///
/// Limits: one entry per robot of the batch, and one per gateway.
/// Thread: confined to the writer.
class BatchShares final {
 public:
  BatchShares(const BatchShare& of_robot, const BatchShare& of_gateway)
      : of_robot_(of_robot), of_gateway_(of_gateway) {}

  /// The decision on a robot's next entry.
  enum class Admission : std::uint8_t {
    kAdmitted,
    /// The robot has its share: its other entries wait for a later batch.
    kRobotWaits,
    /// The gateway has its share: all its robots' entries wait.
    kGatewayWaits,
  };
  /// Decides, and counts the entry if it goes into the batch.
  [[nodiscard]] Admission Admit(const Origin& origin);

 private:
  struct Taken {
    std::size_t records = 0;
    std::size_t bytes = 0;
    bool full = false;

    /// Whether the share has room. If not, it counts as full from now on.
    bool HasRoomFor(std::size_t more, const BatchShare& share);
    void Add(std::size_t more);
  };

  const BatchShare of_robot_;
  const BatchShare of_gateway_;
  std::unordered_map<const robot::CommitClient*, Taken> robots_;
  std::unordered_map<const GatewayUse*, Taken> gateways_;
};

}  // namespace uplink::journal
