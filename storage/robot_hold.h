#pragma once

#include "storage/epoch.h"
#include "storage/identity.h"

namespace uplink::storage {

/// The process that holds a robot, or has its claim, by its row.
struct RobotHold {
  ProcessId owner{};
  /// Of its last stream, adoption or claim.
  Epoch epoch = 0;

  friend bool operator==(const RobotHold&, const RobotHold&) = default;
};

}  // namespace uplink::storage
