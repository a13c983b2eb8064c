#pragma once

#include <cstdint>

namespace uplink::forward {

/// What became of changes, each counted once per receiver. A value.
///
/// due = written + coalesced + replaced + dropped + what waits, at every moment: each is counted
/// where it happens, and none is made of the others.
struct Counts {
  /// At the fan-out of a change: its receivers.
  std::uint64_t due = 0;
  /// Handed to the stream.
  std::uint64_t written = 0;
  /// A later change of the same item took its place.
  std::uint64_t coalesced = 0;
  /// A snapshot that is to come, or has not reached the item yet, holds it.
  std::uint64_t replaced = 0;
  /// Its stream ended.
  std::uint64_t dropped = 0;

  /// Besides: snapshots that began, and their items that were written.
  std::uint64_t snapshots = 0;
  std::uint64_t snapshot_items = 0;
  /// Times that more items waited for a receiver than may: a new snapshot for each.
  std::uint64_t overflows = 0;

  Counts& operator+=(const Counts& other) {
    due += other.due;
    written += other.written;
    coalesced += other.coalesced;
    replaced += other.replaced;
    dropped += other.dropped;
    snapshots += other.snapshots;
    snapshot_items += other.snapshot_items;
    overflows += other.overflows;
    return *this;
  }
};

}  // namespace uplink::forward
