#include "server/fleet/entry.h"

#include <utility>

#include <fmt/format.h>

#include "server/identity/ruri.h"

namespace uplink::fleet {

bool Entry::IsBlocked(std::string_view ruri) const {
  const RobotSettingPtr setting = SettingOf(ruri);
  return setting != nullptr && setting->blocked;
}

std::optional<std::string> Entry::TakeUnnamed() {
  if (!met_unnamed_.load()) return std::nullopt;
  const std::lock_guard lock(mutex_);
  return std::exchange(unnamed_, std::nullopt);
}

robot::Registration Entry::RegistrationOf(std::string_view ruri) const {
  if (!only_registered()) return robot::Registration::kFits;
  const RobotSettingPtr setting = SettingOf(ruri);
  const bool registered = setting != nullptr && setting->registered;
  return registered ? robot::Registration::kFits : robot::Registration::kUnjudged;
}

Refusal Entry::Judge(const Claim& claim, robot::Robot* known, bool robots_read, SystemTime now) {
  const std::string& ruri = claim.robot.ruri;
  const RobotSettingPtr setting = SettingOf(ruri);
  if (setting != nullptr && setting->blocked) return Refusal::kBlocked;
  if (claim.grant == Grant::kFleet) {
    if (only_named_.load()) return Refusal::kGatewayUnnamed;
    if (!met_unnamed_.exchange(true)) {
      const std::lock_guard lock(mutex_);
      unnamed_ = claim.gateway;
    }
  }
  // A gateway that speaks for its fleet moves no robots anyway. A twin has no certificate: the key
  // cyberwave.fleet moves it.
  const bool moves = known != nullptr && claim.grant != Grant::kFleet &&
                     known->id()->fleet != claim.robot.fleet && !identity::NamesTwin(ruri);
  if (moves && claim.bounds != nullptr && !claim.bounds->fleets.Has(known->id()->fleet)) {
    return Refusal::kAuthorityOutside;
  }
  if (known != nullptr && known->registration() == robot::Registration::kFits) {
    return moves && fleets_stay_.load() ? Refusal::kFleetStays : Refusal::kNone;
  }
  if (identity::FlawOfForm(ruri)) {
    return robots_read ? Refusal::kNotCanonical : Refusal::kRobotsUnread;
  }
  if (!only_registered()) {
    // It came while registration was closed, and was not judged yet.
    if (known != nullptr) known->SetRegistration(robot::Registration::kFits);
    return Refusal::kNone;
  }
  if (setting != nullptr && setting->registered) {
    candidates_.Remove(ruri);
    if (known != nullptr) known->SetRegistration(robot::Registration::kFits);
    return Refusal::kNone;
  }
  // Before the store was read no one can tell which robots it knows, and which were added.
  if (!robots_read || !settings_->is_read()) return Refusal::kNone;
  candidates_.Note(claim, now);
  return Refusal::kNotRegistered;
}

void Entry::JudgeAgain(robot::Robot& robot, bool robots_read, SystemTime now) {
  if (robot.registration() != robot::Registration::kUnjudged) return;
  if (!robots_read || !settings_->is_read()) return;
  const std::string gateway = robot.speaker().value_or("");
  const Grant grant = gateway.empty() ? Grant::kOwn : Grant::kNamed;
  const Claim claim{.robot = *robot.id(), .grant = grant, .gateway = gateway};
  if (Judge(claim, &robot, robots_read, now) != Refusal::kNone) robot.RefuseUnjudged();
}

absl::Status StatusOfEntry(Refusal refusal, const Claim& claim) {
  switch (refusal) {
    case Refusal::kBlocked:
      return absl::PermissionDeniedError("blocked");
    case Refusal::kNotRegistered:
      return absl::PermissionDeniedError(
          fmt::format("{} is not registered: an operator must add it first (identity.registration)",
                      claim.robot.ruri));
    case Refusal::kGatewayUnnamed:
      return absl::PermissionDeniedError(
          fmt::format("the certificate of gateway {} names no robots, and it must "
                      "(identity.gateways)",
                      claim.gateway));
    case Refusal::kFleetStays:
      return absl::PermissionDeniedError(
          fmt::format("{} is of another fleet than the certificate, {}, and stays there "
                      "(identity.fleet_moves)",
                      claim.robot.ruri, claim.robot.fleet));
    case Refusal::kAuthorityOutside:
      return absl::PermissionDeniedError(
          fmt::format("client certificate: its authority {} may not move this robot from its fleet",
                      claim.bounds == nullptr ? "" : claim.bounds->authority));
    case Refusal::kNotCanonical:
      return absl::PermissionDeniedError(
          fmt::format("the RURI {} {}, which no new robot's may", claim.robot.ruri,
                      identity::FlawOfForm(claim.robot.ruri).value_or("is not canonical")));
    case Refusal::kRobotsUnread:
      return absl::UnavailableError(fmt::format(
          "the RURI {} {}, and the server has not read yet whether the store has it",
          claim.robot.ruri, identity::FlawOfForm(claim.robot.ruri).value_or("is not canonical")));
    case Refusal::kNone:
    case Refusal::kFull:
    case Refusal::kGatewayFull:
    case Refusal::kOtherFleet:
    case Refusal::kOddFleet:
    case Refusal::kFleetsUnread:
      break;
  }
  return absl::OkStatus();
}

}  // namespace uplink::fleet
