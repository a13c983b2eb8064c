#include "server/session/rcan_order.h"

#include <algorithm>
#include <utility>

#include "server/robot/limits.h"

namespace uplink::session {

RcanOrder::Age RcanOrder::AgeOf(const model::RcanState& state) const {
  if (!last_timestamp_us_ || state.timestamp_us > *last_timestamp_us_) return Age::kNewer;
  return state.timestamp_us == *last_timestamp_us_ ? Age::kSame : Age::kOlder;
}

std::uint64_t RcanOrder::See(const model::RcanState& state) {
  if (!state.seq) return 0;
  const std::optional<std::int64_t> before = last_seq_;
  // A state that comes too late does not restart the numbers.
  if (before && *state.seq < *before && AgeOf(state) == Age::kOlder) return 0;
  last_seq_ = state.seq;
  const std::uint64_t unread = std::exchange(unread_, 0);
  // A smaller number means that the robot restarted, or the number wrapped: nothing is known to be
  // missing.
  if (!before || *state.seq <= *before) return 0;
  const std::uint64_t between = static_cast<std::uint64_t>(*state.seq - *before) - 1;
  const std::uint64_t skipped =
      std::min(between - std::min(between, unread), robot::kMissingPerJumpMax);
  missing_ += skipped;
  return skipped;
}

void RcanOrder::Apply(model::RcanState& state) {
  last_timestamp_us_ = state.timestamp_us;
  state.seq_missing = missing_;
  for (model::RcanJoint& joint : state.joints) {
    const model::RcanJoint* last = last_samples_.Find(joint.joint);
    if (last != nullptr && joint.timestamp_us <= last->timestamp_us) {
      joint = *last;
    } else {
      last_samples_.Put(joint.joint, joint);
    }
  }
}

}  // namespace uplink::session
