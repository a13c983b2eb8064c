#pragma once

#include <cstdint>

namespace uplink::simulation {

/// Faults of forwarding that the simulation plants, one at a time, around the server's own parts.
enum class ForwardFault : std::uint8_t {
  kNone,
  /// Snapshots may begin before the shared set was read whole.
  kBeginsBeforeWhole,
  /// The first page of the shared set is taken for the whole.
  kHalfSet,
  /// The position in the changes is taken after the items were read.
  kPositionAfterItems,
  /// What a change names is looked up before the changes are asked for.
  kStaleLook,
  /// A change of an item that is gone is passed over.
  kDeleteKept,
  /// What waits for a receiver is dropped past the bound, and no snapshot takes its place.
  kDropsWhenFull,
  /// A receiver gets what another fleet shares.
  kOtherFleet,
  /// A receiver gets its own items.
  kOwnItems,
};

}  // namespace uplink::simulation
