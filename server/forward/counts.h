#pragma once

#include <cstdint>

namespace uplink::forward {

/// Counts of changes to shared items, once per receiver. A value.
///
/// due = written + coalesced + replaced + dropped + waiting, at every moment: each is counted where
/// it happens, and none is computed from the others.
struct Counts {
  /// Receivers of a change, at its fan-out.
  std::uint64_t due = 0;
  /// Handed to the stream.
  std::uint64_t written = 0;
  /// A later change of the same item replaced it.
  std::uint64_t coalesced = 0;
  /// A snapshot that has not begun, or not reached the item yet, will hold it.
  std::uint64_t replaced = 0;
  /// Its stream ended.
  std::uint64_t dropped = 0;

  /// Separately: snapshots that began, and their items that were written.
  std::uint64_t snapshots = 0;
  std::uint64_t snapshot_items = 0;
  /// How often too many items waited for a receiver; each time it gets a new snapshot.
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
