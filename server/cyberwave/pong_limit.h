#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>
#include <unordered_map>

#include "schema/base/clock.h"
#include "server/cyberwave/limits.h"

namespace uplink::cyberwave {

/// Lets at most `kMax` pass in any second: exactly, not on average. Confined to its owner.
template <std::size_t kMax>
class PerSecond final {
 public:
  [[nodiscard]] bool IsFull(SteadyTime now) const {
    return size_ == kMax && now - times_[next_] < std::chrono::seconds(1);
  }
  void Add(SteadyTime now) {
    times_[next_] = last_ = now;
    next_ = (next_ + 1) % kMax;
    if (size_ < kMax) ++size_;
  }
  /// When the last one passed.
  [[nodiscard]] SteadyTime last() const { return last_; }

 private:
  /// Of the last ones; once all are there, the oldest stands at next_.
  std::array<SteadyTime, kMax> times_{};
  std::size_t next_ = 0;
  std::size_t size_ = 0;
  SteadyTime last_{};
};

/// How many pings are answered: kPongsOfNameMax per second under one name, kPongsMax in all.
/// Further ones get no answer.
///
/// Limits:  kPongNamesMax names.
/// Thread:  confined to its owner.
class PongLimit final {
 public:
  /// Whether a ping is answered now on that topic (PongTopic); it counts if so.
  [[nodiscard]] bool Take(std::string_view pong_topic, SteadyTime now);

  [[nodiscard]] std::size_t names() const { return by_name_.size(); }

 private:
  PerSecond<kPongsMax> all_;
  std::unordered_map<std::string, PerSecond<kPongsOfNameMax>> by_name_;
};

}  // namespace uplink::cyberwave
