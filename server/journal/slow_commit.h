#pragma once

#include <cstddef>

#include "schema/base/clock.h"

namespace uplink::journal {

/// A commit that takes this long or longer is worth a line of level debug: a disk's flush takes a
/// fraction of it, and robots do not notice it yet.
inline constexpr milliseconds kSlowCommit{100};

/// A commit of the store that took kSlowCommit or longer. A value.
struct SlowCommit {
  std::size_t records = 0;
  std::size_t presence_changes = 0;
  milliseconds took{0};
};

}  // namespace uplink::journal
