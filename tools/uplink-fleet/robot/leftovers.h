#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <utility>

#include "schema/base/clock.h"
#include "tools/uplink-fleet/robot/leftover.h"

namespace uplink::synthetic {

/// Connections that one robot has left behind; at it the oldest is cut.
inline constexpr std::size_t kLeftoversMax = 8;

/// The connections that a robot has left behind and that are not over yet.
///
/// Thread: confined to the loop's thread.
class Leftovers final {
 public:
  /// Makes room for one more.
  void MakeRoom() {
    if (leftovers_.size() < kLeftoversMax) return;
    leftovers_.front()->Cut();
    leftovers_.pop_front();
  }
  void Add(std::unique_ptr<Leftover> leftover) { leftovers_.push_back(std::move(leftover)); }
  void DropOver(SteadyTime now) {
    std::erase_if(leftovers_, [now](const auto& each) { return each->over(now); });
  }
  void Clear() { leftovers_.clear(); }

 private:
  std::deque<std::unique_ptr<Leftover>> leftovers_;
};

}  // namespace uplink::synthetic
