#pragma once

#include <cstdint>
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
  /// As whom calls speak; `moves`: they may take the robot to their fleet. True if it is somebody
  /// else than before.
  bool SpeakAs(const fleet::Claim& claim, bool moves, journal::Journal& journal) {
    word_ = moves ? storage::FleetWord::kMoves : storage::FleetWord::kMatches;
    if (speaks_ && gateway_ == claim.gateway) return false;
    speaks_ = true;
    gateway_ = claim.gateway;
    use_ = journal.GatewayOf(gateway_);
    return true;
  }
  /// The robot's fleet changed: the next claim tells the store. `is_free`: nothing waits that was
  /// judged under this one.
  void TellFleet(bool is_free) {
    is_other_fleet_ = false;
    asked_at_ = {};
    Doubt();
    if (is_free) epoch_ = 0;
  }

  /// Whether it is to be asked for now. One that there is stays while something waits that was
  /// judged under it, and as long as this process has the robot.
  [[nodiscard]] bool IsDue(SteadyTime now, bool waits, bool is_foreign) {
    if (is_asked_) return false;
    if (epoch_ == 0 && !is_other_fleet_) return true;
    const bool may_be_ours = is_other_fleet_ || is_foreign;
    // From now on nothing more is judged under it, so that what waits comes to an end.
    if (may_be_ours && !is_doubtful() && now - asked_at_ >= robot::kClaimAgainEvery) Doubt();
    return is_doubtful() && !waits;
  }
  void Ask(SteadyTime now) {
    is_asked_ = true;
    asked_at_ = now;
    settles_ = doubts_;
  }
  void Take(const storage::ClaimResult& result) {
    is_asked_ = false;
    epoch_ = result.claim;
    settled_ = settles_;
    is_other_fleet_ = result.other_fleet.has_value();
  }
  void Void() { epoch_ = 0; }
  /// What is remembered of the store is to be asked for anew, once nothing waits: what does was
  /// judged under this claim, and is stored unless another server claimed since.
  void Doubt() { ++doubts_; }

  /// Of what waits; 0: there is none.
  [[nodiscard]] storage::Epoch epoch() const { return epoch_; }
  /// Whether a sample can be judged under it. While another is asked for none can: nothing of two
  /// claims waits at a time.
  [[nodiscard]] bool serves() const { return epoch_ != 0 && !is_doubtful() && !is_asked_; }
  [[nodiscard]] bool is_doubtful() const { return settled_ != doubts_; }
  [[nodiscard]] bool is_asked() const { return is_asked_; }
  /// The store has the robot in another fleet.
  [[nodiscard]] bool is_other_fleet() const { return is_other_fleet_; }
  [[nodiscard]] storage::FleetWord word() const { return word_; }
  [[nodiscard]] const std::string& gateway() const { return gateway_; }
  [[nodiscard]] const journal::GatewayRef& use() const { return use_; }

 private:
  storage::Epoch epoch_ = 0;
  /// Doubts that there were; those that the claim that is asked for settles; those that are
  /// settled.
  std::uint64_t doubts_ = 0;
  std::uint64_t settles_ = 0;
  std::uint64_t settled_ = 0;
  bool is_asked_ = false;
  bool is_other_fleet_ = false;
  SteadyTime asked_at_;
  storage::FleetWord word_ = storage::FleetWord::kMoves;
  bool speaks_ = false;
  std::string gateway_;
  /// Counts what waits in the journal of all that the gateway brings.
  journal::GatewayRef use_;
};

}  // namespace uplink::uncrew
