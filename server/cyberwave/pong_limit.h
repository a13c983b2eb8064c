#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <unordered_map>

#include "schema/base/clock.h"
#include "server/cyberwave/limits.h"
#include "server/limits/recent_times.h"

namespace uplink::cyberwave {

/// Limits the pings that are answered: kPongsOfNameMax per second under one name, kPongsMax in all.
/// Further ones get no answer. Unlike limits::KeyedBuckets this is exact, and has room for each new
/// name: fewer than kPongNamesMax got a pong within a second.
///
/// Limits:  kPongNamesMax names.
/// Thread:  confined to its owner.
class PongLimit final {
 public:
  /// Whether a ping is answered now on that topic (PongTopic); it counts if so.
  [[nodiscard]] bool Take(std::string_view pong_topic, SteadyTime now);

  [[nodiscard]] std::size_t names() const { return by_name_.size(); }

 private:
  limits::RecentTimes<kPongsMax> all_;
  std::unordered_map<std::string, limits::RecentTimes<kPongsOfNameMax>> by_name_;
};

}  // namespace uplink::cyberwave
