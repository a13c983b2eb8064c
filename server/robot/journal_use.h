#pragma once

#include <cstddef>

namespace uplink::robot {

/// What of one robot waits in the journal. A value.
struct JournalUse {
  /// Gaps included.
  std::size_t records = 0;
  std::size_t bytes = 0;
};

}  // namespace uplink::robot
