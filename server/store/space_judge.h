#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "storage/disk_space.h"

namespace uplink::store {

/// Whether the store's disk has enough room to store.
enum class SpaceState : std::uint8_t {
  kEnough,
  /// Below store.free_min: robots that store far more than the others are slowed down.
  kScarce,
  /// Below half of it: nothing is stored.
  kStopped,
};

/// store.free_min if it is not set: this share of the disk, at most so many bytes.
inline constexpr std::uint64_t kFreePercent = 5;
inline constexpr std::uint64_t kFreeBytesMax = std::uint64_t{1} << 30;

/// What must be free on a disk of that size; `configured` is store.free_min, 0 if not set. At most
/// half of the disk, whatever the setting.
[[nodiscard]] std::uint64_t FreeMinOf(std::uint64_t configured, std::uint64_t total_bytes);

/// What a look at the disk found. A value.
struct SpaceFacts {
  std::uint64_t free_bytes = 0;
  std::uint64_t free_min = 0;
  /// As judged last.
  SpaceState before = SpaceState::kEnough;
};

/// A pure function. Once free space fell below a bound, the state holds until 1.2 times the bound
/// is free again, so that it does not flip with every row.
[[nodiscard]] SpaceState JudgeSpace(const SpaceFacts& facts);

/// The state of the store's disk, and what is done about it. A value.
struct SpaceView {
  /// Empty if it cannot be known.
  std::optional<storage::DiskSpace> space;
  /// The minimum that it is judged by; 0 if nothing is known.
  std::uint64_t free_min = 0;
  SpaceState state = SpaceState::kEnough;
  /// Robots that may store no more than the median does.
  std::size_t robots_limited = 0;
};

}  // namespace uplink::store
