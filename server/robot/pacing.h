#pragma once

#include <array>
#include <map>
#include <string>

#include "schema/base/clock.h"
#include "schema/model/rejection.h"
#include "server/limits/recent_times.h"

namespace uplink::robot {

/// How often a robot's mistakes get a Notice, or a payload in quarantine: each kind once per
/// second. Confined to its owner's lock.
///
/// Bounds: one time per reason, and one per field of at most kNoticeFieldsMax fields.
class Pacing final {
 public:
  /// Whether the payload of a rejection for this reason is kept now: one per second.
  [[nodiscard]] bool KeepPayload(model::RejectReason reason, SteadyTime now);
  /// Whether a Notice of this field may be sent now: one per second and field; all indices of a
  /// list count as one field.
  [[nodiscard]] bool MayNotice(const std::string& field, SteadyTime now);

 private:
  std::array<limits::RecentTimes<1>, model::kRejectReasons + 1> payload_kept_;
  std::map<std::string, limits::RecentTimes<1>> noticed_;
};

}  // namespace uplink::robot
