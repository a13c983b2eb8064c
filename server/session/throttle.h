#pragma once

#include <cstdint>
#include <optional>

#include "schema/base/clock.h"

namespace uplink::session {

/// Counts the malformed messages of one stream, and says when there were too many in one second
/// (kMalformedPerSecondMax). Confined to the stream's thread.
class Throttle final {
 public:
  void AddMalformed(SteadyTime now);
  /// When messages may be processed again after too many malformed ones in this second, also if
  /// that has come; nothing without too many.
  [[nodiscard]] std::optional<SteadyTime> end() const;

 private:
  SteadyTime since_{};
  std::uint32_t malformed_ = 0;
};

}  // namespace uplink::session
