#include "server/robot/fleet_words.h"

#include <utility>

namespace uplink::robot {

FleetWords::Effect FleetWords::Say(const FleetSaid& said, loop::StreamRef stream) {
  using storage::FleetWord;
  Effect effect{.word = said.word};
  if (untold_) {
    const bool same = untold_->fleet == said.fleet;
    effect.disowns = untold_->word == FleetWord::kMatches && !same;
    if (untold_->word == FleetWord::kMoves && same) effect.word = FleetWord::kMoves;
  }
  untold_ = FleetSaid{.fleet = said.fleet, .word = effect.word};
  stream_ = stream;
  return effect;
}

std::optional<FleetWords::Refused> FleetWords::Refuse() {
  if (!untold_) return std::nullopt;
  Refused refused{.stream = stream_, .claimed = std::move(untold_->fleet)};
  untold_.reset();
  return refused;
}

}  // namespace uplink::robot
