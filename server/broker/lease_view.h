#pragma once

#include <cstdint>
#include <string>

#include "schema/base/clock.h"
#include "server/broker/twin_streams.h"
#include "storage/deliveries.h"

namespace uplink::broker {

/// This process has the lease of its topics. A value.
struct Grant {
  storage::TopicHoldRef hold;
  /// What its client id's last holder knew.
  storage::DeliveryMemory memory;
  /// The faults of metrics that are active in the store.
  FaultsByRobot faults;
};

/// What the store has by now, under the lease that this process has. A value.
struct Remembered {
  /// The last RereadSoon that was asked before it was read.
  std::uint64_t asked = 0;
  storage::DeliveryMemory memory;
  FaultsByRobot faults;
};

/// Who has the lease of our topics, as the thread that asks the store last found. Thread: any.
class LeaseView {
 public:
  virtual ~LeaseView() = default;
  /// Whether a connection may be made now: the lease was ours at a look that began at or after
  /// `since`, or the store cannot be asked and it was ours a moment ago.
  [[nodiscard]] virtual bool MayConnect(SteadyTime since) const = 0;
  /// A look is wanted soon: somebody ended a connection of ours, which another process may have
  /// now.
  virtual void LookSoon() = 0;
  /// What the store remembers of deliveries and has of faults is to be read again soon: whether
  /// what waited was committed is not known here, or the store may lack what was. `asked` grows; it
  /// is told by Broker::GoOn.
  virtual void RereadSoon(std::uint64_t asked) = 0;
  /// The store could not be asked at the last look.
  [[nodiscard]] virtual bool failing() const = 0;
  /// Where the process that has the lease is; empty: it is ours, or nobody's.
  [[nodiscard]] virtual std::string held_by() const = 0;
};

}  // namespace uplink::broker
