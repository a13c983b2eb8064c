#pragma once

#include <atomic>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include <absl/status/status.h>

#include "schema/base/clock.h"
#include "server/fleet/candidates.h"
#include "server/fleet/claim.h"
#include "server/fleet/robot_settings.h"
#include "server/robot/robot.h"

namespace uplink::fleet {

/// The keys of [identity] that decide which robots come in. A value.
struct EntryRules {
  /// identity.registration = "closed": a robot that is not known comes in only if an operator added
  /// it.
  bool only_registered = false;
  /// identity.gateways = "named": a gateway's certificate must name its robots.
  bool only_named = false;
  /// identity.fleet_moves = "refuse": a certificate of another fleet does not move a robot.
  bool fleets_stay = false;
};

/// Which robots come in, beside certificates and bounds: by the rules, and by what operators set.
///
/// Thread: thread-safe. It only calls RobotSettings and Candidates.
class Entry final {
 public:
  /// Nothing is set of any robot, and all come in.
  Entry() = default;
  /// `settings` outlives it. Call it before the first thread.
  void Set(const EntryRules& rules, const RobotSettings& settings) {
    Follow(rules);
    settings_ = &settings;
  }
  /// The rules from now on, for robots that come: those that are in stay.
  void Follow(const EntryRules& rules) {
    only_registered_.store(rules.only_registered);
    only_named_.store(rules.only_named);
    fleets_stay_.store(rules.fleets_stay);
  }
  [[nodiscard]] bool only_registered() const { return only_registered_.load(); }

  /// A robot that is refused because it is not registered becomes a candidate. `known`: it is in
  /// memory. `robots_read`: the robots of the store were read, so one that is not known is new.
  [[nodiscard]] Refusal Judge(const Claim& claim, robot::Robot* known, bool robots_read,
                              SystemTime now);
  /// The same for a robot that is in memory since before the store was read, once that can be told.
  void JudgeAgain(robot::Robot& robot, bool robots_read, SystemTime now);
  /// Of a new robot that Judge lets in.
  [[nodiscard]] robot::Registration RegistrationOf(std::string_view ruri) const;
  [[nodiscard]] bool IsBlocked(std::string_view ruri) const;
  /// Whether the claim brings the robot into its fleet, from whichever the robot was in.
  [[nodiscard]] bool Moves(const Claim& claim) const {
    return claim.grant != Grant::kFleet && !fleets_stay_.load() && claim.bounds == nullptr;
  }
  /// The same from this fleet.
  [[nodiscard]] bool Moves(const Claim& claim, std::string_view from) const {
    return claim.grant != Grant::kFleet && !fleets_stay_.load() &&
           (claim.bounds == nullptr || claim.bounds->fleets.Has(from));
  }
  /// The subject of the first gateway that came without names. Nothing until one came, and after
  /// the first call that returned it.
  [[nodiscard]] std::optional<std::string> TakeUnnamed();
  [[nodiscard]] Candidates& candidates() { return candidates_; }
  [[nodiscard]] const Candidates& candidates() const { return candidates_; }

 private:
  [[nodiscard]] RobotSettingPtr SettingOf(std::string_view ruri) const {
    return settings_ == nullptr ? nullptr : settings_->Find(ruri);
  }

  // Of EntryRules.
  std::atomic<bool> only_registered_{false};
  std::atomic<bool> only_named_{false};
  std::atomic<bool> fleets_stay_{false};
  const RobotSettings* settings_ = nullptr;
  /// A gateway came without names.
  std::atomic<bool> met_unnamed_{false};
  std::mutex mutex_;
  std::optional<std::string> unnamed_;
  Candidates candidates_;
};

/// The status that tells a robot why it may not come in: kPermissionDenied, and kUnavailable for
/// kRobotsUnread. OK for a refusal that Entry does not give.
[[nodiscard]] absl::Status StatusOfEntry(Refusal refusal, const Claim& claim);

}  // namespace uplink::fleet
