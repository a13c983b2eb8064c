#pragma once

#include "storage/epoch.h"
#include "storage/identity.h"

namespace uplink::storage {

/// Who holds a robot, as its row says.
struct RobotHold {
  ProcessId owner{};
  /// Of its last stream, or adoption.
  Epoch epoch = 0;

  friend bool operator==(const RobotHold&, const RobotHold&) = default;
};

}  // namespace uplink::storage
