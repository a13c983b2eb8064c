#pragma once

#include <cstdint>
#include <string>

#include "schema/base/clock.h"
#include "server/fleet/claim.h"
#include "server/journal/journal.h"
#include "server/robot/limits.h"
#include "storage/claim.h"

namespace uplink::uncrew {

/// The claim of one drone, as this process knows it, and the speaker in whose name it is made.
///
/// Thread: confined to its owner's lock.
class DroneClaim final {
 public:
  /// The speaker has moved the robot to its fleet: its word moves it in the store too, until that
  /// has answered.
  void Move() { moving_ = true; }
  /// Sets the speaker of the calls; `moves`: it may move the robot to its fleet from any. True if
  /// the speaker is another one than before.
  bool SpeakAs(const fleet::Claim& claim, bool moves, journal::Journal& journal) {
    word_ = moves || moving_ ? storage::FleetWord::kMoves : storage::FleetWord::kMatches;
    if (speaks_ && gateway_ == claim.gateway) return false;
    speaks_ = true;
    gateway_ = claim.gateway;
    use_ = journal.GatewayOf(gateway_);
    return true;
  }
  /// The robot's fleet changed: the next claim tells the store. `is_free`: no sample waits that was
  /// judged under this claim.
  void TellFleet(bool is_free) {
    is_other_fleet_ = false;
    asked_at_ = {};
    Doubt();
    if (is_free) epoch_ = 0;
  }

  /// Whether to ask for a claim now. A valid one stays while samples wait that were judged under
  /// it, and while this process has the robot.
  [[nodiscard]] bool IsDue(SteadyTime now, bool waits, bool is_foreign) {
    if (is_asked_) return false;
    if (epoch_ == 0 && !is_other_fleet_) return true;
    const bool may_be_ours = is_other_fleet_ || is_foreign;
    // From now on no sample is judged under it, so that no sample waits soon.
    if (may_be_ours && !is_doubtful() && now - asked_at_ >= robot::kClaimAgainEvery) Doubt();
    return is_doubtful() && !waits;
  }
  void Ask(SteadyTime now) {
    is_asked_ = true;
    asked_at_ = now;
    asked_moves_ = moving_;
    settles_ = doubts_;
  }
  void Take(const storage::ClaimResult& result) {
    is_asked_ = false;
    if (asked_moves_) moving_ = false;
    epoch_ = result.claim;
    settled_ = settles_;
    is_other_fleet_ = result.other_fleet.has_value();
  }
  void Void() { epoch_ = 0; }
  /// Memory of the store is in doubt: ask for a new claim once no sample waits. Samples that wait
  /// were judged under this one, and are stored unless another server claimed since.
  void Doubt() { ++doubts_; }

  /// The claim of waiting samples; 0: there is none.
  [[nodiscard]] storage::Epoch epoch() const { return epoch_; }
  /// Whether a sample can be judged under it. None can while another claim is open, so that all
  /// waiting samples have the same claim.
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
  /// The number of doubts so far; of those that the open claim settles; of those that are settled.
  std::uint64_t doubts_ = 0;
  std::uint64_t settles_ = 0;
  std::uint64_t settled_ = 0;
  bool is_asked_ = false;
  bool is_other_fleet_ = false;
  bool moving_ = false;
  bool asked_moves_ = false;
  SteadyTime asked_at_;
  storage::FleetWord word_ = storage::FleetWord::kMoves;
  bool speaks_ = false;
  std::string gateway_;
  /// The waiting records of all robots of its gateway in the journal.
  journal::GatewayRef use_;
};

}  // namespace uplink::uncrew
