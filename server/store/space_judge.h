#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "storage/disk_space.h"

namespace uplink::store {

/// How much the store's disk has left, for what it does about it.
enum class SpaceState : std::uint8_t {
  kEnough,
  /// Below store.free_min: robots that store far more than the others are slowed down.
  kScarce,
  /// Below half of it: nothing is stored.
  kStopped,
};

/// store.free_min where it is not set: this share of the disk, at most so much.
inline constexpr std::uint64_t kFreePercent = 5;
inline constexpr std::uint64_t kFreeBytesMax = std::uint64_t{1} << 30;

/// What must be free on a disk of that size; `configured` is store.free_min, 0 if it is not set. At
/// most half of the disk: no setting can ask for more than a disk has.
[[nodiscard]] std::uint64_t FreeMinOf(std::uint64_t configured, std::uint64_t total_bytes);

/// What a look at the disk found. A value.
struct SpaceFacts {
  std::uint64_t free_bytes = 0;
  std::uint64_t free_min = 0;
  /// As judged last.
  SpaceState before = SpaceState::kEnough;
};

/// A pure function. Each bound that was passed counts until 1.2 times of it are free again, so that
/// the state does not change back and forth with every row.
[[nodiscard]] SpaceState JudgeSpace(const SpaceFacts& facts);

/// What is known of the store's disk, and what is done about it. A value.
struct SpaceView {
  /// Nothing where it cannot be known.
  std::optional<storage::DiskSpace> space;
  /// Of which the judgement is made; 0 where nothing is known.
  std::uint64_t free_min = 0;
  SpaceState state = SpaceState::kEnough;
  /// Robots that may store no more than the median does.
  std::size_t robots_limited = 0;
};

}  // namespace uplink::store
