#pragma once

#include <cstdint>
#include <string>

#include "schema/base/clock.h"
#include "server/broker/twin_streams.h"
#include "storage/deliveries.h"

namespace uplink::broker {

/// A lease of topics that this process took. A value.
struct Grant {
  storage::TopicHoldRef hold;
  /// Deliveries that the last holder of its client id remembered.
  storage::DeliveryMemory memory;
  /// The faults of metrics that are active in the store.
  FaultsByRobot faults;
};

/// What the store has now, under the lease that this process has. A value.
struct Remembered {
  /// The number of the last RereadSoon before the read.
  std::uint64_t asked = 0;
  storage::DeliveryMemory memory;
  FaultsByRobot faults;
};

/// Who has the lease of our topics, as of the last look at the store. Thread: any.
class LeaseView {
 public:
  virtual ~LeaseView() = default;
  /// Whether a connection may be made now: the lease was ours at a look that began at or after
  /// `since`, or the store cannot be asked and it was ours a moment ago.
  [[nodiscard]] virtual bool MayConnect(SteadyTime since) const = 0;
  /// Asks for a look soon: a connection of ours ended, perhaps because another process has the
  /// lease now.
  virtual void LookSoon() = 0;
  /// Asks to read soon what the store has of deliveries and faults: this process does not know
  /// whether waiting records were committed, or the store may have lost some. `asked` grows;
  /// Broker::Resume gets it back.
  virtual void RereadSoon(std::uint64_t asked) = 0;
  /// The last look at the store failed.
  [[nodiscard]] virtual bool failing() const = 0;
  /// The address of the process that has the lease; empty if that is this one or none.
  [[nodiscard]] virtual std::string held_by() const = 0;
};

}  // namespace uplink::broker
