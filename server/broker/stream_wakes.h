#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <vector>

#include "server/loop/wake.h"

namespace uplink::broker {

/// Tells the broker's thread which streams have news; many wakes become one look.
///
/// Limits:  one number per wake since the last look.
/// Thread:  thread-safe.
class StreamWakes final : public loop::WakeInbox {
 public:
  /// Calls `look` for the first wake after each Take.
  explicit StreamWakes(std::function<void()> look) : look_(std::move(look)) {}

  void Wake(std::uint64_t stream) override;
  /// The streams that were woken since the last call, each once.
  [[nodiscard]] std::vector<std::uint64_t> Take();

 private:
  const std::function<void()> look_;
  std::mutex mutex_;
  std::vector<std::uint64_t> woken_;
};

}  // namespace uplink::broker
