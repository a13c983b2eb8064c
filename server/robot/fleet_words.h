#pragma once

#include <optional>
#include <string>

#include "server/loop/wake.h"
#include "storage/open_stream.h"

namespace uplink::robot {

/// What a stream says of its robot's fleet. A value.
struct FleetSaid {
  std::string fleet = {};
  storage::FleetWord word = storage::FleetWord::kMoves;
};

/// What the robot's last stream said of its fleet, until the store has answered that. Confined to
/// its owner's lock.
class FleetWords final {
 public:
  struct Effect {
    /// What the store is to be told: a word that moves the robot stands until the store was told.
    storage::FleetWord word = storage::FleetWord::kMoves;
    /// An earlier stream spoke for another fleet by a word that moves nothing, and the store will
    /// never judge it: what waits of that stream is void.
    bool disowns = false;
  };
  /// A stream says this, and the store is about to be asked.
  [[nodiscard]] Effect Say(const FleetSaid& said, loop::StreamRef stream);
  /// The store has the robot in that fleet, or all that waited is void.
  void Answered() { untold_.reset(); }

  struct Refused {
    loop::StreamRef stream;
    /// The fleet that it said.
    std::string claimed;
  };
  /// The store has the robot in another fleet. Whose word that was; nothing if it was answered.
  [[nodiscard]] std::optional<Refused> Refuse();

 private:
  std::optional<FleetSaid> untold_;
  loop::StreamRef stream_;
};

}  // namespace uplink::robot
