#pragma once

#include <cstddef>

#include "schema/base/clock.h"

namespace uplink::journal {

/// A commit that takes as long is worth a line of level debug: several times what a disk takes for
/// its flush, and a part of what robots notice.
inline constexpr milliseconds kSlowCommit{100};

/// One commit of the store. A value.
struct SlowCommit {
  std::size_t records = 0;
  std::size_t presence_changes = 0;
  milliseconds took{0};
};

}  // namespace uplink::journal
