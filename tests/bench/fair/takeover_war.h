#pragma once

#include <array>
#include <memory>

#include "tests/bench/fair/misbehaviour.h"

namespace uplink::bench {

/// Two connections with a session each. Whichever lost the robot takes it back at once.
class TakeoverWar final : public Misbehaviour {
 public:
  explicit TakeoverWar(BadWorld& world) : world_(world) {}

  void Act() override;
  [[nodiscard]] bool at_work() const override { return world_.counts.welcomes > 1; }

 private:
  struct Side {
    BadSession session = NewBadSession();
    std::unique_ptr<BadStream> stream;
    bool sent = false;
  };
  void ActOn(Side& side);

  BadWorld& world_;
  std::array<Side, 2> sides_;
};

}  // namespace uplink::bench
