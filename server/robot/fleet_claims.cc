#include "server/robot/fleet_claims.h"

#include <utility>

namespace uplink::robot {

FleetClaims::Effect FleetClaims::Add(const FleetClaim& claim, loop::StreamRef stream) {
  using storage::FleetWord;
  Effect effect{.word = claim.word};
  if (unanswered_) {
    const bool same = unanswered_->fleet == claim.fleet;
    effect.disowns = unanswered_->word == FleetWord::kMatches && !same;
    if (unanswered_->word == FleetWord::kMoves && same) effect.word = FleetWord::kMoves;
  }
  unanswered_ = FleetClaim{.fleet = claim.fleet, .word = effect.word};
  stream_ = stream;
  return effect;
}

std::optional<FleetClaims::Refused> FleetClaims::Refuse() {
  if (!unanswered_) return std::nullopt;
  Refused refused{.stream = stream_, .claimed = std::move(unanswered_->fleet)};
  unanswered_.reset();
  return refused;
}

}  // namespace uplink::robot
