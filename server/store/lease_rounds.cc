#include "server/store/lease_rounds.h"

#include <utility>
#include <vector>

#include "server/config/address.h"

namespace uplink::store {

static_assert(fleet::Fleet::kReplacedKnown >= kLateAfter + kLookEvery,
              "a process that has not noticed another store by then counts as late");

LeaseRounds::LeaseRounds(std::unique_ptr<storage::Leases> leases, Context context)
    : leases_(std::move(leases)),
      context_(std::move(context)),
      judge_({.self = context_.process,
              .time_to_move = context_.presence.timeout,
              .is_gone = context_.is_gone,
              .cut_off_max = context_.presence.adopted_grace}),
      looked_(context_.clock.Steady()),
      rounds_("leases", [this](const auto& /*stop*/) -> loop::Next {
        const SteadyTime began = context_.clock.Steady();
        Round();
        return {.within = began + kLookEvery - context_.clock.Steady()};
      }) {}

void LeaseRounds::SetPort(std::uint16_t port) {
  port_.store(port);
  renews_now_.store(true);
}

void LeaseRounds::Round() {
  if (leases_ == nullptr) return;
  const SteadyTime began = context_.clock.Steady();
  absl::Status looked = Look();
  // The connection may only have ended since the last look. A new one shows at once what the old
  // one would have shown, so that nothing was missed. A store that shuts this program out has
  // answered.
  const bool answered = looked.ok() || absl::IsUnimplemented(looked);
  if (!answered && context_.clock.Steady() - began < kLookEvery) looked = Look();
  if (!looked.ok()) judge_.NoteFailure(context_.clock.Steady());
  if (looked.ok()) NoteVerdicts();
  NoteOutcome(looked);
  NoteLate();
}

std::optional<LeaseJudge::Verdict> LeaseRounds::VerdictOf(const storage::ProcessId& process) {
  // This process has the store alone: its previous holder is over.
  if (leases_ == nullptr) return LeaseJudge::Verdict{.over = Over::kGone};
  {
    const std::lock_guard lock(mutex_);
    const auto asked = verdicts_.find(process);
    if (asked != verdicts_.end()) return asked->second;
    if (verdicts_.size() >= kVerdictsMax) verdicts_.clear();
    verdicts_.emplace(process, std::nullopt);
  }
  rounds_.Wake();
  return std::nullopt;
}

void LeaseRounds::NoteVerdicts() {
  const std::lock_guard lock(mutex_);
  for (auto& [process, verdict] : verdicts_) verdict = judge_.Of(process);
}

void LeaseRounds::NoteLate() {
  auto late = judge_.Late();
  context_.probe.others_late.Set(static_cast<std::int64_t>(late.size()));
  context_.probe.others_unseen.Set(judge_.blind() || !late.empty() ? 1 : 0);
  for (const auto& [process, name] : late) {
    if (!late_.contains(process)) context_.logger.Warn("process_late", {{"process", name}});
  }
  late_ = std::move(late);
}

bool LeaseRounds::OthersUnseen() const {
  if (leases_ == nullptr) return false;
  if (context_.probe.others_unseen.value() > 0) return true;
  // The look under way may hang.
  const SteadyTime::duration silent = context_.clock.Steady() - looked_.load();
  return silent > kLookGapMax && silent <= kLookGapMax + context_.presence.adopted_grace;
}

absl::Status LeaseRounds::Look() {
  const SteadyTime began = context_.clock.Steady();
  absl::Status looked = LookAtLeases();
  if (looked.ok()) looked = FollowRobots();
  if (looked.ok()) context_.fleet.NoteStoreLooked(began);
  return looked;
}

absl::Status LeaseRounds::LookAtLeases() {
  const SteadyTime began = context_.clock.Steady();
  if (!renewed_ || began - *renewed_ >= kRenewEvery || renews_now_.exchange(false)) {
    const storage::ProcessCard card{
        .name = config::ToText({.host = HostName(), .port = port_.load()}),
        .life = LifeOfThisProcess()};
    if (absl::Status renewed = leases_->Renew(card); !renewed.ok()) return renewed;
    renewed_ = began;
    context_.probe.renewed.Add();
  }
  const auto leases = leases_->Read();
  if (!leases.ok()) return leases.status();
  // Taken when the answer is here: a slow answer is older than it looks, never younger.
  const SteadyTime now = context_.clock.Steady();
  looked_.store(now);
  FollowServer();
  judge_.NoteLook(now, *leases);
  context_.probe.others.Set(static_cast<std::int64_t>(judge_.others()));
  return absl::OkStatus();
}

void LeaseRounds::FollowServer() {
  const std::string before = std::exchange(server_run_, leases_->ServerRun());
  if (before.empty() || before == server_run_) return;
  judge_.NoteReplaced();
  context_.fleet.NoteStoreReplaced();
  // A writer notices a broken connection only by its next call, and may have none to make.
  for (journal::Journal* const journal : context_.journals.all()) journal->WhenCommitted({});
}

absl::Status LeaseRounds::FollowRobots() {
  std::string after;
  Listed listed;
  while (true) {
    const auto robots = leases_->RobotsOfOthers(after);
    if (!robots.ok()) return robots.status();
    if (robots->empty()) break;
    // The whole page first: a holder that wrote of one robot also judges the others.
    for (const storage::ForeignRobot& foreign : *robots) {
      if (foreign.written_at) judge_.NoteWritten(foreign.holder, *foreign.written_at);
    }
    for (const storage::ForeignRobot& foreign : *robots) Follow(foreign, listed);
    after = robots->back().robot.ruri;
    // During a long list, keep our own lease and the looks at others alive.
    if (context_.clock.Steady() - looked_.load() < kLookEvery) continue;
    if (absl::Status looked = LookAtLeases(); !looked.ok()) return looked;
  }
  judge_.EndList();
  LogEnded(listed);
  TakeUnlisted(listed);
  return absl::OkStatus();
}

void LeaseRounds::LogEnded(const Listed& listed) {
  std::set<storage::ProcessId> over;
  for (const auto& [process, ended] : listed.ended) {
    over.insert(process);
    if (over_.contains(process)) continue;
    context_.logger.Warn("process_over", {{"process", ended.holder.name},
                                          {"why", ToText(ended.holder.over)},
                                          {"robots", ended.robots}});
  }
  over_ = std::move(over);
}

void LeaseRounds::TakeUnlisted(const Listed& listed) {
  if (!adopts_.load()) return;
  // Their previous holder may have been silent.
  const milliseconds grace = context_.presence.adopted_grace;
  std::map<std::string, int> unlisted;
  for (const fleet::RobotPtr& robot : context_.fleet.All()) {
    bool foreign = false;
    robot->state.LookAt([&](const robot::StateView& view) { foreign = view.foreign; });
    if (!foreign || robot->leaving() || robot->HasStream() || listed.robots.contains(robot.get()))
      continue;
    const auto before = unlisted_.find(robot->ruri());
    const int looks = before == unlisted_.end() ? 1 : before->second + 1;
    unlisted.emplace(robot->ruri(), looks);
    if (looks > kUnlistedLooksMax) {
      context_.fleet.BeginLeaving(*robot, robot::Robot::LeaveWhen::kAtOnce);
      continue;
    }
    context_.journals.Adopt({.client = robot.get(),
                             .request = {.robot = robot->id(), .holder = context_.process},
                             .grace = {.ended = grace, .silent = grace}});
  }
  unlisted_ = std::move(unlisted);
}

fleet::RobotPtr LeaseRounds::FindOrAdmit(const storage::ForeignRobot& foreign) {
  fleet::RobotPtr robot = context_.fleet.Find(foreign.robot.ruri);
  const SystemTime heard_at = foreign.written_at.value_or(SystemTime());
  if (robot == nullptr) {
    if (foreign.written_at && context_.is_forgotten(heard_at)) return nullptr;
    // Robots past limits.robots_max are not shown; their holder has them.
    const auto admitted = context_.fleet.AdmitNew(foreign.robot);
    if (!admitted.ok()) return nullptr;
    // Null if the robot came by itself just now.
    robot = *admitted != nullptr ? *admitted : context_.fleet.Find(foreign.robot.ruri);
    if (robot != nullptr) robot->NoteHeard(context_.clock.System());
  } else {
    robot->NoteHeard(heard_at);
  }
  return robot;
}

void LeaseRounds::Follow(const storage::ForeignRobot& foreign, Listed& listed) {
  const fleet::RobotPtr known = FindOrAdmit(foreign);
  if (known == nullptr) return;
  robot::Robot& robot = *known;
  listed.robots.insert(&robot);
  const LeaseJudge::Verdict holder = judge_.Of(foreign.holder);
  const storage::Epoch held_since = robot.state.held_since();
  if (held_since >= foreign.held_since) return;  // it came here since this was read
  if (held_since != 0) {
    // It opened a stream of a robot that was ours.
    judge_.NoteSign(foreign.holder);
    context_.journals.Lose({.client = &robot, .robot = robot.id(), .since = foreign.held_since});
    return;
  }
  // A stream of it is here, and the store is about to learn of that.
  if (robot.HasStream()) return;
  robot.SetFleet(foreign.robot.fleet);
  if (foreign.last_session) robot.sessions.Restore(*foreign.last_session);
  const storage::StoredPresence presence = foreign.presence.value_or(
      storage::StoredPresence{model::Presence::kUnknown, robot.state.presence_since()});
  robot.state.FollowHolder({.held_by = holder.name, .written_at = foreign.written_at}, presence);
  if (holder.over == Over::kNo) return;
  Ended& ended = listed.ended.try_emplace(foreign.holder, Ended{.holder = holder}).first->second;
  ++ended.robots;
  if (adopts_.load()) Adopt(robot, foreign, holder);
}

void LeaseRounds::Adopt(robot::Robot& robot, const storage::ForeignRobot& foreign,
                        const LeaseJudge::Verdict& holder) {
  context_.journals.Adopt({.client = &robot,
                           .request = {.robot = robot.id(),
                                       .holder = foreign.holder,
                                       .lease_counter = holder.counter,
                                       .end = EndOf(holder.over)},
                           .grace = {.ended = context_.presence.startup_grace,
                                     .silent = context_.presence.adopted_grace}});
}

void LeaseRounds::NoteOutcome(const absl::Status& status) {
  if (absl::IsUnimplemented(status)) {
    if (std::exchange(shut_out_, true)) return;
    context_.logger.Error("store_outdated_program", {{"error", std::string(status.message())}});
    return context_.on_shut_out();
  }
  const bool fails = !status.ok();
  context_.probe.failing.Set(fails ? 1 : 0);
  if (fails == failing_) return;
  failing_ = fails;
  if (fails) {
    context_.logger.Warn("lease_fails", {{"why", std::string(status.message())}});
  } else {
    context_.logger.Info("lease_works_again", {});
  }
}

LeaseRounds::Left LeaseRounds::Leave() {
  Stop();
  if (leases_ == nullptr) return Left::kToNone;
  const absl::Status released = leases_->Release();
  if (!released.ok()) {
    context_.logger.Warn("lease_not_released", {{"why", std::string(released.message())}});
  }
  // After the release, so that a later one sees that this process has released.
  if (const auto leases = leases_->Read(); leases.ok()) {
    judge_.NoteLook(context_.clock.Steady(), *leases);
    context_.probe.others.Set(static_cast<std::int64_t>(judge_.others()));
  }
  return judge_.others() > 0 ? Left::kToOthers : Left::kToNone;
}

void LeaseRounds::Start() {
  if (leases_ != nullptr) rounds_.Start();
}

}  // namespace uplink::store
