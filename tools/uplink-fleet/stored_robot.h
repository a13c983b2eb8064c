#pragma once

#include <vector>

#include "uplink/v1/fleet.pb.h"

namespace uplink::synthetic {

/// What the store holds of one robot. A value.
struct StoredRobot {
  std::vector<v1::Fault> faults;
  std::vector<v1::Fault> active_faults;
  std::vector<v1::Quarantined> quarantine;
  std::vector<v1::Gap> gaps;
};

}  // namespace uplink::synthetic
