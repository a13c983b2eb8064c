#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "tools/uplink-fleet/robot/first_text.h"

namespace uplink::synthetic {

/// What twins do: publish; wait until all of it is acked; publish each live value once more and be
/// quiet; leave.
enum class TwinStage : std::uint8_t { kSend, kSettle, kLast, kClose };

/// What the threads of twins and the run tell each other. Thread-safe.
struct TwinsShared {
  std::atomic<TwinStage> stage{TwinStage::kSend};
  /// Give up what is not done.
  std::atomic<bool> abandon{false};
  // Groups that have come to the end of that stage.
  std::atomic<std::size_t> settled_groups{0};
  std::atomic<std::size_t> quiet_groups{0};
  std::atomic<std::uint64_t> connections{0};
  std::atomic<std::uint64_t> breaks{0};
  std::atomic<std::uint64_t> published{0};
  std::atomic<std::uint64_t> published_qos1{0};
  std::atomic<std::uint64_t> acked{0};
  std::atomic<std::uint64_t> skipped{0};
  std::atomic<std::uint64_t> pings{0};
  std::atomic<std::uint64_t> pongs{0};

  FirstText first_error;
};

}  // namespace uplink::synthetic
