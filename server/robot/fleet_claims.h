#pragma once

#include <optional>
#include <string>

#include "server/loop/wake.h"
#include "storage/open_stream.h"

namespace uplink::robot {

/// A stream's claim about its robot's fleet. A value.
struct FleetClaim {
  std::string fleet = {};
  storage::FleetWord word = storage::FleetWord::kMoves;
};

/// The last stream's claim about the robot's fleet, until the store has answered it. Confined to
/// its owner's lock.
class FleetClaims final {
 public:
  struct Effect {
    /// What to tell the store: a claim that moves the robot holds until the store has answered it.
    storage::FleetWord word = storage::FleetWord::kMoves;
    /// An earlier stream claimed another fleet without moving the robot, and the store will never
    /// judge that: the waiting messages of that stream are void.
    bool disowns = false;
  };
  /// A stream makes this claim, and the store is about to be asked.
  [[nodiscard]] Effect Add(const FleetClaim& claim, loop::StreamRef stream);
  /// The store confirmed that fleet, or all that waited is void.
  void Answered() { unanswered_.reset(); }

  struct Refused {
    loop::StreamRef stream;
    /// The fleet that it claimed.
    std::string claimed;
  };
  /// The store has the robot in another fleet. Returns the stream that claimed; empty if it was
  /// answered.
  [[nodiscard]] std::optional<Refused> Refuse();

 private:
  std::optional<FleetClaim> unanswered_;
  loop::StreamRef stream_;
};

}  // namespace uplink::robot
