#pragma once

#include "schema/base/clock.h"

namespace uplink::storage {

/// Whether civil time may decide that something is over. A clock that jumps ahead makes everything
/// look old; so until the clock is vouched for, nothing is deleted, forgotten or taken for expired.
///
/// Thread: thread-safe. It is asked each time, since the answer changes while the server runs.
class ClockTrust {
 public:
  virtual ~ClockTrust() = default;
  /// The civil clock, as it stands now, is vouched for.
  [[nodiscard]] virtual bool vouched() const = 0;
  /// It is, and `time`, which was read from it once, is not later: what came during a jump may be
  /// looked at after it.
  [[nodiscard]] virtual bool VouchesFor(SystemTime time) const = 0;
};

/// Null is a part without a judgement of its clock: a test, whose time is what it says.
[[nodiscard]] inline bool Vouches(const ClockTrust* trust, SystemTime time) {
  return trust == nullptr || trust->VouchesFor(time);
}

}  // namespace uplink::storage
