#pragma once

#include "storage/forget_requests.h"
#include "storage/robot_removal.h"

namespace uplink::storage {

/// What it takes to forget a robot: both sides of a store, over one connection beside the writers.
///
/// Thread: both together are confined to one thread at a time.
class ForgetStore {
 public:
  virtual ~ForgetStore() = default;

  [[nodiscard]] virtual RobotRemoval& removal() = 0;
  [[nodiscard]] virtual ForgetRequests& requests() = 0;
};

}  // namespace uplink::storage
