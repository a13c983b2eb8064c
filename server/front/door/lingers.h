#pragma once

#include <cstddef>
#include <mutex>
#include <optional>

#include "server/front/door/key_table.h"
#include "server/limits/key_counts.h"

namespace uplink::front {

/// Connections that have lost their place and linger, so that their peers learn why. Each holds a
/// descriptor that nothing else counts.
///
/// Limits: `max` in all, and kLingersPerKeyMax of each key.
/// Thread: thread-safe.
class Lingers final {
 public:
  /// As many as a robot's key may have connections: opening them faster keeps no more of them.
  static constexpr std::size_t kLingersPerKeyMax = 4;

  explicit Lingers(std::size_t max) : max_(max) {}

  /// Adds one, of this key if it has shown one; false if there are too many. Each Begin that
  /// returned true needs an End with the same key.
  [[nodiscard]] bool Begin(const std::optional<KeyDigest>& key);
  void End(const std::optional<KeyDigest>& key);

 private:
  const std::size_t max_;
  std::mutex mutex_;
  std::size_t all_ = 0;
  limits::KeyCounts<KeyDigest> by_key_;
};

}  // namespace uplink::front
