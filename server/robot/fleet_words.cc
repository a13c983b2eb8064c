#include "server/robot/fleet_words.h"

#include <utility>

namespace uplink::robot {

FleetWords::Heard FleetWords::Say(const FleetSaid& said, loop::StreamRef stream) {
  using storage::FleetWord;
  Heard heard{.word = said.word};
  if (untold_) {
    const bool same = untold_->fleet == said.fleet;
    heard.disowns = untold_->word == FleetWord::kMatches && !same;
    if (untold_->word == FleetWord::kMoves && same) heard.word = FleetWord::kMoves;
  }
  untold_ = FleetSaid{.fleet = said.fleet, .word = heard.word};
  stream_ = stream;
  return heard;
}

std::optional<FleetWords::Refused> FleetWords::Refuse() {
  if (!untold_) return std::nullopt;
  Refused refused{.stream = stream_, .claimed = std::move(untold_->fleet)};
  untold_.reset();
  return refused;
}

}  // namespace uplink::robot
