#include "server/uncrew/drones.h"

#include <utility>

#include <fmt/format.h>

#include "server/uncrew/limits.h"

namespace uplink::uncrew {
namespace {

absl::Status Refused(fleet::Refusal refusal, const fleet::Claim& claim, const fleet::Fleet& fleet) {
  switch (refusal) {
    case fleet::Refusal::kNone:
      break;
    case fleet::Refusal::kFull:
      return absl::ResourceExhaustedError(fmt::format(
          "the server admits no more than {} robots (limits.robots_max)", fleet.robots_max()));
    case fleet::Refusal::kGatewayFull:
      return absl::ResourceExhaustedError(
          fmt::format("gateway {} has brought in {} robots, and may bring in no more",
                      claim.gateway, fleet.gateway_robots_max()));
    case fleet::Refusal::kOtherFleet:
      if (claim.grant != fleet::Grant::kFleet) {
        return fleet::StatusOfEntry(claim.bounds == nullptr ? fleet::Refusal::kFleetStays
                                                            : fleet::Refusal::kAuthorityOutside,
                                    claim);
      }
      return absl::PermissionDeniedError(
          fmt::format("the certificate of gateway {} may not speak for {}: the robot is of another "
                      "fleet, and the certificate does not name it",
                      claim.gateway, claim.robot.ruri));
    case fleet::Refusal::kOddFleet:
      return absl::UnauthenticatedError(
          "client certificate: its O holds an invisible character, and the store has no "
          "robot of that fleet");
    case fleet::Refusal::kFleetsUnread:
      return absl::UnavailableError(
          "client certificate: its O holds an invisible character, and the server has not "
          "read yet whether the store has robots of that fleet");
    case fleet::Refusal::kBlocked:
    case fleet::Refusal::kNotRegistered:
    case fleet::Refusal::kGatewayUnnamed:
    case fleet::Refusal::kFleetStays:
    case fleet::Refusal::kAuthorityOutside:
    case fleet::Refusal::kNotCanonical:
    case fleet::Refusal::kRobotsUnread:
      return fleet::StatusOfEntry(refusal, claim);
  }
  return absl::OkStatus();
}

fleet::Refusal JudgeFleet(fleet::Fleet& fleet, const fleet::Claim& claim) {
  using Verdict = fleet::OddFleets::Verdict;
  switch (fleet.odd_fleets().Judge(claim.robot.fleet)) {
    case Verdict::kFits:
      break;
    case Verdict::kRefused:
      return fleet::Refusal::kOddFleet;
    case Verdict::kUnread:
      return fleet::Refusal::kFleetsUnread;
  }
  return fleet::Refusal::kNone;
}

}  // namespace

absl::StatusOr<fleet::Fleet::Admission> Drones::Admit(const fleet::Claim& claim) {
  fleet::Fleet::Admission admission = context_.fleet.FindOrAdmitBy(claim);
  if (admission.robot == nullptr) return Refused(admission.refusal, claim, context_.fleet);
  return admission;
}

absl::StatusOr<DronePtr> Drones::Enter(const fleet::Claim& claim) {
  const DronePtr known = Find(claim.robot.ruri);
  if (known != nullptr) {
    const auto refusal = context_.fleet.Judge(claim, known->robot().get());
    if (refusal != fleet::Refusal::kNone) return Refused(refusal, claim, context_.fleet);
  }
  if (known == nullptr || known->robot()->id()->fleet != claim.robot.fleet) {
    if (const auto refusal = JudgeFleet(context_.fleet, claim); refusal != fleet::Refusal::kNone) {
      return Refused(refusal, claim, context_.fleet);
    }
  }
  fleet::RobotPtr robot;
  bool moved = false;
  if (known == nullptr) {
    auto admitted = Admit(claim);
    if (!admitted.ok()) return admitted.status();
    robot = std::move(admitted->robot);
    moved = admitted->moved;
  }
  const std::lock_guard lock(mutex_);
  DronePtr& drone = drones_[claim.robot.ruri];
  const bool leaves = robot != nullptr && robot->calls.asked_to_end(context_.clock.Steady());
  if (drone == nullptr && (robot == nullptr || leaves)) {
    drones_.erase(claim.robot.ruri);
    return absl::UnavailableError("the drone was let go of just now: send the same sample again");
  }
  if (drone == nullptr) {
    drone =
        std::make_shared<Drone>(Drone::Context{.clock = context_.clock,
                                               .ledger = context_.ledger,
                                               .journal = context_.journals.Of(claim.robot.ruri),
                                               .live_total = context_.fleet.live_total(),
                                               .session = DrawSession()},
                                robot);
    context_.fleet.Keep(*robot);
  }
  if (!drone->SetSpeaker(claim, context_.fleet.entry(), moved)) {
    return Refused(fleet::Refusal::kOtherFleet, claim, context_.fleet);
  }
  // Under the lock, so that Round drops no drone that has a call.
  if (!drone->Enter(context_.clock.System())) {
    return absl::ResourceExhaustedError(
        fmt::format("{} calls of the drone wait for their answer already", kCallsInFlightMax));
  }
  return drone;
}

DronePtr Drones::Find(std::string_view ruri) const {
  const std::lock_guard lock(mutex_);
  const auto found = drones_.find(std::string(ruri));
  return found == drones_.end() ? nullptr : found->second;
}

std::vector<DronePtr> Drones::All() const {
  const std::lock_guard lock(mutex_);
  std::vector<DronePtr> all;
  all.reserve(drones_.size());
  for (const auto& [ruri, drone] : drones_) all.push_back(drone);
  return all;
}

void Drones::Round() {
  const SystemTime idle_since = context_.clock.System() - kDroneIdleMax;
  const SteadyTime now = context_.clock.Steady();
  const std::lock_guard lock(mutex_);
  std::erase_if(drones_, [idle_since, now](const auto& each) {
    const Drone& drone = *each.second;
    const bool goes = drone.called_at() < idle_since || drone.robot()->calls.asked_to_end(now);
    return goes && drone.idle();
  });
}

std::size_t Drones::size() const {
  const std::lock_guard lock(mutex_);
  return drones_.size();
}

model::SessionId Drones::DrawSession() {
  constexpr std::size_t kBytesOfNumber = sizeof(std::uint64_t);
  std::array<std::uint8_t, model::SessionId::kBytes> bytes{};
  for (std::size_t at = 0; at < bytes.size(); at += kBytesOfNumber) {
    const std::uint64_t drawn = random_();
    for (std::size_t i = 0; i < kBytesOfNumber; ++i) {
      bytes[at + i] = static_cast<std::uint8_t>(drawn >> (8 * i));
    }
  }
  return model::SessionId(bytes);
}

}  // namespace uplink::uncrew
