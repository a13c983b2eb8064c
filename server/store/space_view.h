#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "server/store/space_judge.h"
#include "storage/disk_space.h"

namespace uplink::store {

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
