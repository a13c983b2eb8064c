#include "server/fleet/fleet.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <utility>

#include <fmt/format.h>

namespace uplink::fleet {

Fleet::Fleet(const Clock& clock, std::size_t robots_max, const robot::PresenceLimits& presence,
             const robot::PresenceLimits& twins, const BootClock* boot)
    : clock_(clock),
      robots_max_(robots_max),
      presence_(presence),
      twins_(twins),
      started_(clock.Steady()),
      boot_(boot),
      gateway_robots_(GatewayRobotsMax(robots_max)) {}

Fleet::Shard& Fleet::ShardOf(std::string_view ruri) {
  return shards_[std::hash<std::string_view>{}(ruri) % kShards];
}

const Fleet::Shard& Fleet::ShardOf(std::string_view ruri) const {
  return shards_[std::hash<std::string_view>{}(ruri) % kShards];
}

absl::StatusOr<RobotPtr> Fleet::FindOrAdmit(const model::RobotId& id) {
  const Claim claim{.robot = id};
  Admission admission = FindOrAdmitBy(claim);
  if (admission.robot != nullptr) return std::move(admission.robot);
  if (absl::Status status = StatusOfEntry(admission.refusal, claim); !status.ok()) return status;
  return Full();
}

Fleet::Admission Fleet::FindOrAdmitBy(const Claim& claim) {
  const model::RobotId& id = claim.robot;
  Shard& shard = ShardOf(id.ruri);
  const std::lock_guard lock(shard.mutex);
  const auto found = shard.robots.find(id.ruri);
  const bool is_known = found != shard.robots.end();
  const Refusal refusal = Judge(claim, is_known ? found->second.get() : nullptr);
  if (refusal != Refusal::kNone) return {.robot = nullptr, .refusal = refusal};
  if (!is_known) return AdmitBy(shard, claim);
  if (claim.grant != Grant::kFleet) {
    gateway_robots_.Remove(id.ruri);
  } else if (found->second->id()->fleet != id.fleet) {
    return {.robot = nullptr, .refusal = Refusal::kOtherFleet};
  }
  // If another robot got its place meanwhile, there is one more than robots_max; kLeavingMax bounds
  // these.
  Keep(*found->second);
  const bool moved = found->second->id()->fleet != id.fleet;
  found->second->SetFleet(id.fleet);
  return {.robot = found->second, .moved = moved};
}

Fleet::Admission Fleet::AdmitBy(Shard& shard, const Claim& claim) {
  const std::string& ruri = claim.robot.ruri;
  if (claim.grant == Grant::kFleet && !gateway_robots_.Add(ruri, claim.gateway)) {
    return {.robot = nullptr, .refusal = Refusal::kGatewayFull};
  }
  if (TakePlace() || (MakeRoom() && TakePlace())) {
    return {.robot = Admit(shard, claim.robot, entry_.RegistrationOf(ruri))};
  }
  gateway_robots_.Remove(ruri);
  return {.robot = nullptr, .refusal = Refusal::kFull};
}

absl::StatusOr<RobotPtr> Fleet::AdmitNew(const model::RobotId& id) {
  odd_fleets_.Know(id.fleet);
  Shard& shard = ShardOf(id.ruri);
  const std::lock_guard lock(shard.mutex);
  if (const auto found = shard.robots.find(id.ruri); found != shard.robots.end()) {
    found->second->SetRegistration(robot::Registration::kFits);
    return nullptr;
  }
  if (!TakePlace()) return Full();
  return Admit(shard, id);
}

bool Fleet::TakePlace() {
  if (all_.fetch_add(1) < robots_max_ + leaving_.load()) return true;
  all_.fetch_sub(1);
  return false;
}

absl::Status Fleet::Full() const {
  return absl::ResourceExhaustedError(
      fmt::format("the server admits no more than {} robots (limits.robots_max)", robots_max_));
}

RobotPtr Fleet::Admit(Shard& shard, const model::RobotId& id, robot::Registration registration) {
  auto robot = std::make_shared<robot::Robot>(std::make_shared<const model::RobotId>(id),
                                              started_.load(), clock_, changed_);
  robot->state.CountIn(live_total_);
  robot->SetBlocked(entry_.IsBlocked(id.ruri));
  robot->SetRegistration(registration);
  shard.robots.emplace(id.ruri, robot);
  const std::lock_guard lock(admitted_mutex_);
  admitted_.push_back(robot);
  // Last: who sees the change finds the robot.
  changes_.fetch_add(1);
  return robot;
}

RobotPtr Fleet::Find(std::string_view ruri) const {
  const Shard& shard = ShardOf(ruri);
  const std::lock_guard lock(shard.mutex);
  const auto found = shard.robots.find(std::string(ruri));
  return found == shard.robots.end() ? nullptr : found->second;
}

std::vector<RobotPtr> Fleet::All() const {
  const std::lock_guard lock(admitted_mutex_);
  return admitted_;
}

std::vector<RobotPtr> Fleet::Sorted() const {
  std::vector<RobotPtr> robots = All();
  std::ranges::sort(robots, {},
                    [](const RobotPtr& robot) -> const std::string& { return robot->ruri(); });
  return robots;
}

void Fleet::OnSettings(std::span<const RobotSettings::Change> changes) {
  for (const RobotSettings::Change& change : changes) {
    RobotPtr robot;
    {
      Shard& shard = ShardOf(change.ruri);
      const std::lock_guard lock(shard.mutex);
      const auto found = shard.robots.find(change.ruri);
      if (found == shard.robots.end()) continue;
      robot = found->second;
      // By the settings, not by the change, which may be older than what an admission saw.
      robot->SetBlocked(entry_.IsBlocked(change.ruri));
    }
    if (robot->blocked()) {
      robot->sessions.EndStream(robot::Standing::kBlocked).Wake();
    } else if (change.disconnect && !IsTwin(*robot)) {
      robot->sessions.EndStream(robot::Standing::kDisconnected).Wake();
    }
  }
}

void Fleet::SetRoom(std::vector<std::weak_ptr<robot::Robot>> room) {
  const std::lock_guard lock(room_mutex_);
  room_ = std::move(room);
}

bool Fleet::MakeRoom() {
  const std::lock_guard lock(room_mutex_);
  while (!room_.empty()) {
    const RobotPtr robot = room_.back().lock();
    room_.pop_back();
    if (robot != nullptr && robot->idle() && BeginLeaving(*robot)) return true;
  }
  return false;
}

bool Fleet::BeginLeaving(robot::Robot& robot, robot::Robot::LeaveWhen when) {
  if (leaving_.load() >= kLeavingMax || !robot.BeginLeaving(when)) return false;
  leaving_.fetch_add(1);
  return true;
}

void Fleet::Keep(robot::Robot& robot) {
  if (robot.Stay()) leaving_.fetch_sub(1);
}

std::vector<RobotPtr> Fleet::Leaving() const {
  std::vector<RobotPtr> leaving;
  if (leaving_.load() == 0) return leaving;
  const std::lock_guard lock(admitted_mutex_);
  std::ranges::copy_if(admitted_, std::back_inserter(leaving),
                       [](const RobotPtr& robot) { return robot->leaving(); });
  return leaving;
}

std::vector<RobotPtr> Fleet::RemoveLeft() {
  std::vector<RobotPtr> left = Leaving();
  std::erase_if(left, [this](RobotPtr& robot) { return !Remove(robot); });
  return left;
}

bool Fleet::Remove(const RobotPtr& robot) {
  // The caller's, the shard's and the list's.
  constexpr long kKeptByUs = 3;
  Shard& shard = ShardOf(robot->ruri());
  const std::lock_guard lock(shard.mutex);
  const std::lock_guard admitted_lock(admitted_mutex_);
  // No one can find it while both locks are held. A holder of the pointer may go on using it.
  if (!robot->left() || robot.use_count() != kKeptByUs) return false;
  std::erase(admitted_, robot);
  shard.robots.erase(robot->ruri());
  gateway_robots_.Remove(robot->ruri());
  leaving_.fetch_sub(1);
  all_.fetch_sub(1);
  changes_.fetch_add(1);
  forgotten_.fetch_add(1);
  return true;
}

void Fleet::BeginListening() {
  const SteadyTime now = clock_.Steady();
  started_.store(now);
  for (const RobotPtr& robot : All()) robot->state.BeginListening(now);
}

SteadyTime::duration Fleet::StoodStill(SteadyTime now) {
  const SteadyTime at = boot_ == nullptr ? now : boot_->Boot();
  const SteadyTime last = last_sweep_.exchange(at);
  const SteadyTime::duration since = last == SteadyTime() ? SteadyTime::duration(0) : at - last;
  return since > kSweepLate ? since : SteadyTime::duration(0);
}

void Fleet::ApplyHearing(robot::Robot& robot, HearingState hearing, SteadyTime now) {
  switch (hearing) {
    case HearingState::kUpToDate:
      return;
    case HearingState::kHereAlone:
      if (!robot.HasStream()) break;
      if (robot.state.AskBeforeOffline(now, presence_limits_of(robot)))
        robot.sessions.stream().Wake();
      return;
    case HearingState::kBehind:
      break;
  }
  robot.state.NoteStall(now);
}

PresenceCounts Fleet::Sweep(milliseconds session_idle, HearingState hearing,
                            HearingState twins_hearing) {
  const SteadyTime steady = clock_.Steady();
  const SystemTime system = clock_.System();
  PresenceCounts counts;
  FleetTallies tallies;
  // A sweep that comes late means that we stood still: the robots' messages may lie unread. They
  // are taken before the next sweep, which judges.
  const SteadyTime::duration stood_still = StoodStill(steady);
  const bool stalled = stood_still > SteadyTime::duration(0);
  stood_still_for_.store(stood_still);
  for (const RobotPtr& robot : All()) {
    JudgeAgain(*robot, system);
    const robot::PresenceLimits& limits = presence_limits_of(*robot);
    if (stalled) {
      const bool breaks = stood_still >= kStandstillBreaks;
      robot->state.NoteStall(breaks ? robot::EndOfStallWithGrace(steady, limits) : steady);
      continue;
    }
    ApplyHearing(*robot, IsTwin(*robot) ? twins_hearing : hearing, steady);
    robot->sessions.Sweep(steady, session_idle);
    const std::optional<robot::Presence> presence = robot->state.Sweep(steady, system, limits);
    const storage::RobotRef id = robot->id();
    FleetTally& tally = tallies[id->fleet];
    if (presence) {
      tally.here.Count(*presence, robot->state);
    } else {
      tally.elsewhere.Count(robot->state.presence(), robot->state);
    }
    const auto expires = robot->agent.certificate_not_after();
    if (expires && *expires - system < kCertificateExpiring) ++tally.certificates_expiring;
  }
  if (stalled) return presence_counts();
  for (const auto& [name, tally] : tallies) {
    counts += tally.here;
    counts.elsewhere += tally.elsewhere;
  }
  tallies = shown_fleets_.Fold(tallies);
  const std::lock_guard lock(counts_mutex_);
  counts_ = counts;
  tallies_ = std::move(tallies);
  return counts;
}

void Fleet::NoteTwinsUnheard() {
  const SteadyTime now = clock_.Steady();
  for (const RobotPtr& robot : All()) {
    if (IsTwin(*robot)) robot->state.NoteStall(now);
  }
}

void Fleet::NoteStoreReplaced() {
  const SteadyTime now = clock_.Steady();
  const robot::PresenceTrack::Replaced replaced = {.doubted = store_looked_.load(),
                                                   .until = now + kReplacedKnown,
                                                   .system_now = clock_.System()};
  for (const RobotPtr& robot : All()) robot->state.NoteReplaced(replaced);
}

FleetTallies Fleet::fleet_tallies() const {
  const std::lock_guard lock(counts_mutex_);
  if (tallies_.empty()) return {{std::string(kOtherFleets), FleetTally()}};
  return tallies_;
}

}  // namespace uplink::fleet
