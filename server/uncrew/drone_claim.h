#pragma once

#include <string>

#include "schema/base/clock.h"
#include "server/fleet/claim.h"
#include "server/journal/journal.h"
#include "server/robot/limits.h"
#include "storage/claim.h"

namespace uplink::uncrew {

/// The claim of one drone, as this process knows it, and as whom it is asked for.
///
/// Thread: confined to its owner's lock.
class DroneClaim final {
 public:
  /// As whom calls speak; `moves`: they may take the robot to their fleet.
  void SpeakAs(const fleet::Claim& claim, bool moves, journal::Journal& journal) {
    word_ = moves ? storage::FleetWord::kMoves : storage::FleetWord::kMatches;
    if (gateway_ == claim.gateway) return;
    gateway_ = claim.gateway;
    use_ = journal.GatewayOf(gateway_);
  }
  /// The robot's fleet changed: the next claim tells the store. `is_free`: nothing waits that was
  /// judged under this one.
  void TellFleet(bool is_free) {
    is_other_fleet_ = false;
    asked_at_ = {};
    if (is_free) epoch_ = 0;
  }

  /// Whether it is to be asked for now. One that there is stays while something waits that was
  /// judged under it, and as long as this process has the robot.
  [[nodiscard]] bool IsDue(SteadyTime now, bool waits, bool is_foreign) const {
    if (is_asked_) return false;
    if (epoch_ == 0 && !is_other_fleet_) return true;
    return !waits && (is_other_fleet_ || is_foreign) && now - asked_at_ >= robot::kClaimAgainEvery;
  }
  void Ask(SteadyTime now) {
    is_asked_ = true;
    asked_at_ = now;
  }
  void Take(const storage::ClaimResult& result) {
    is_asked_ = false;
    epoch_ = result.claim;
    is_other_fleet_ = result.other_fleet.has_value();
  }
  void Void() { epoch_ = 0; }

  /// 0: there is none.
  [[nodiscard]] storage::Epoch epoch() const { return epoch_; }
  [[nodiscard]] bool is_asked() const { return is_asked_; }
  /// The store has the robot in another fleet.
  [[nodiscard]] bool is_other_fleet() const { return is_other_fleet_; }
  [[nodiscard]] storage::FleetWord word() const { return word_; }
  [[nodiscard]] const std::string& gateway() const { return gateway_; }
  [[nodiscard]] const journal::GatewayRef& use() const { return use_; }

 private:
  storage::Epoch epoch_ = 0;
  bool is_asked_ = false;
  bool is_other_fleet_ = false;
  SteadyTime asked_at_;
  storage::FleetWord word_ = storage::FleetWord::kMoves;
  std::string gateway_;
  /// Counts what waits in the journal of all that the gateway brings.
  journal::GatewayRef use_;
};

}  // namespace uplink::uncrew
