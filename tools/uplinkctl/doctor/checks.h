#pragma once

#include <string>

#include <sys/types.h>

#include "schema/base/clock.h"
#include "server/config/load.h"
#include "tools/uplinkctl/doctor/finding.h"
#include "tools/uplinkctl/doctor/machine_facts.h"

namespace uplink::ctl {

/// What the checks go by.
struct CheckContext {
  /// As they could be read; keys at fault hold their defaults and are passed over.
  const config::LoadResult& configuration;
  /// Read before root's rights were dropped.
  const MachineFacts& machine;
  /// Who this process is now, for people.
  std::string user;
  uid_t uid = 0;
  const Clock& clock;
};

/// Gathers the facts of each part and judges them, in the order in which an operator reads them:
/// certificates, store, disk, ports, descriptors and clock; of a running server, what it says of
/// itself in place of the clock. Each wait is bounded by postgres_check.h or kProbeDeadline.
///
/// Thread: any; asks files, the store and the server, and changes nothing.
[[nodiscard]] Findings CheckAll(const CheckContext& context);

}  // namespace uplink::ctl
