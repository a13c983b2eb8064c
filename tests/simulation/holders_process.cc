#include "tests/simulation/holders_process.h"

#include <array>
#include <utility>

#include "schema/base/check.h"
#include "server/journal/turns.h"
#include "tests/support/kept_lines.h"

namespace uplink::simulation {
namespace {

constexpr std::chrono::hours kSessionIdle{1};
constexpr std::chrono::seconds kSweepEvery{1};
constexpr std::chrono::seconds kCheckpointEvery{10};

/// True once each `every`; the next time counts from this one.
bool IsDue(std::optional<SteadyTime>& last, milliseconds every, SteadyTime now) {
  if (last && now - *last < every) return false;
  last = now;
  return true;
}

}  // namespace

HoldersProcess::HoldersProcess(const Ground& ground)
    : ground_(ground),
      store_(ContextOfStore()),
      logger_(std::make_unique<testing::NoLines>(), ground_.clock, log::Format::kText,
              log::Level::kError),
      fleet_(ground_.clock, kHoldersRobotsMax,
             ground_.fault == HoldersFault::kNoGraceAfterStandstill
                 ? robot::PresenceLimits{.startup_grace = milliseconds(0)}
                 : robot::PresenceLimits(),
             {}, ground_.fault == HoldersFault::kSuspendUnnoticed ? nullptr : &ground_.boot),
      journal_(store_, {}, ground_.clock, ledger_, journal_probe_, ground_.id),
      loader_({fleet_, shards_, store_.reader(), std::nullopt}),
      restore_(fleet_, store_.reader()),
      checkpoint_({.fleet = fleet_, .writes = [](std::string_view) { return true; }}),
      leases_(std::make_unique<HoldersLeases>(store_, ContextOfStore()), ContextOfLeases()),
      liveness_(ground_.clock, streams_total_),
      watch_({ground_.clock, fleet_, liveness_, logger_, sweep_seconds_, kSessionIdle, [this] {
                return ground_.fault != HoldersFault::kLateIsForgotten && leases_.OthersUnseen();
              }}) {
  fleet_.OnPresence(
      [this](const storage::RobotRef& robot, const storage::StoredPresence& now, auto why) {
        shards_.NotePresence(robot, now.presence, now.since, why, now.parked_until);
      });
  journal_.CheckpointFrom(checkpoint_, kCheckpointEvery);
  journal_.OnReconnected([this](journal::Reconnected to) {
    const bool excuses = ground_.fault == HoldersFault::kReconnectExcuses;
    if (excuses || to == journal::Reconnected::kMayHaveGoneBack) fleet_.NoteStoreReplaced();
  });
}

HoldersStore::Context HoldersProcess::ContextOfStore() {
  return {.database = ground_.database,
          .truth = ground_.truth,
          .random = ground_.random,
          .process = ground_.id,
          .name = ground_.name,
          .fault = ground_.fault,
          .has_stream = [this](const std::string& ruri) { return streams_.contains(ruri); }};
}

store::LeaseRounds::Context HoldersProcess::ContextOfLeases() {
  config::PresenceConfig presence;
  presence.adopted_grace = ground_.fault == HoldersFault::kShortGrace
                               ? presence.startup_grace
                               : milliseconds(kHoldersAdoptedGrace);
  return {.fleet = fleet_,
          .journals = shards_,
          .clock = ground_.clock,
          .logger = logger_,
          .probe = lease_probe_,
          .process = ground_.id,
          .presence = presence,
          .is_gone = ground_.is_gone};
}

void HoldersProcess::Start() {
  if (store_.away()) return;
  UPLINK_CHECK(loader_.Run(kHoldersRobotsMax).ok(), "the simulated store can be read");
  Round();
}

void HoldersProcess::Step(std::size_t writes, bool hears) {
  std::array<std::function<void()>, 5> steps{[this] { Round(); }, [this] { Sweep(); },
                                             [this] { Read(); }, [this, writes] { Write(writes); },
                                             [this, hears] { AskRelay(hears); }};
  for (std::size_t left = steps.size(); left > 0; --left) {
    std::swap(steps[ground_.random.Below(left)], steps[left - 1]);
    steps[left - 1]();
  }
  if (hears) AskPeers();
}

void HoldersProcess::AskPeers() {
  const std::set<std::uint64_t> woken = std::exchange(woken_, {});
  for (const auto& [ruri, stream] : streams_) {
    robot::RobotState& state = fleet_.Find(ruri)->state;
    if (woken.contains(stream) && state.TakeAskPeer()) asked_peers_.insert(ruri);
    if (!asked_peers_.contains(ruri)) continue;
    if (ground_.fault != HoldersFault::kHalfOpenAnswers && !ground_.peer_answers(ruri, stream)) {
      continue;
    }
    asked_peers_.erase(ruri);
    state.NotePeerAnswered(ground_.clock.Steady(), fleet_.presence_limits());
  }
}

void HoldersProcess::Round() {
  if (IsDue(round_, store::kLookEvery, ground_.clock.Steady())) leases_.Round();
}

void HoldersProcess::Sweep() {
  if (draining || !IsDue(sweep_, kSweepEvery, ground_.clock.Steady())) return;
  if (ground_.fault == HoldersFault::kStandstillJudges) {
    fleet_.Sweep(kSessionIdle);
  } else {
    watch_.Sweep();
  }
}

void HoldersProcess::Read() {
  if (store_.away()) return;
  if (!loader_.done()) UPLINK_CHECK(loader_.Run(kHoldersRobotsMax).ok(), "the store can be read");
  UPLINK_CHECK(restore_.Run().ok(), "the simulated store can be read");
}

void HoldersProcess::Write(std::size_t steps) {
  for (; steps > 0; --steps) {
    if (journal_.turns().Advance() != journal::Step::kWorked) return;
  }
}

void HoldersProcess::AskRelay(bool hears) {
  if (IsDue(asked_, fleet::kHandshakeEvery, ground_.clock.Steady())) {
    watch_.AskRelay([this](std::function<void(bool)> done) { answer_ = std::move(done); });
  }
  if (hears && answer_) std::exchange(answer_, nullptr)(true);
}

std::uint64_t HoldersProcess::Open(const storage::RobotRef& id) {
  const SteadyTime now = ground_.clock.Steady();
  const auto admitted = fleet_.FindOrAdmit(*id);
  UPLINK_CHECK(admitted.ok(), "a simulated fleet is not full");
  robot::Robot& robot = **admitted;
  const std::uint64_t stream = next_stream_++;
  const auto attached =
      robot.sessions.Attach({.inbox = this, .stream = stream}, now, ground_.clock.System());
  UPLINK_CHECK(attached.standing == robot::Standing::kCurrent, "its older streams have ended");
  const model::SessionId session({ground_.id[0], ground_.id[1]});
  const auto begun = robot.sessions.Begin(session, now);
  UPLINK_CHECK(begun.has_value(), "it has one session here");
  robot.state.Claim(now);
  journal_.Open(robot, begun->open_id,
                {.robot = id, .session = session, .at = ground_.clock.System()});
  streams_[id->ruri] = stream;
  return stream;
}

bool HoldersProcess::Superseded(const std::string& ruri, std::uint64_t stream) {
  return fleet_.Find(ruri)->sessions.StandingOf({.inbox = this, .stream = stream}) !=
         robot::Standing::kCurrent;
}

void HoldersProcess::Close(const std::string& ruri, std::uint64_t stream) {
  // As session::Attachment::Detach.
  robot::Robot& robot = *fleet_.Find(ruri);
  robot.state.EndParkingStream(ground_.clock.Steady());
  robot.sessions.Detach({.inbox = this, .stream = stream}, ground_.clock.Steady());
  if (!robot.HasStream()) robot.state.EndClaim();
  streams_.erase(ruri);
  asked_peers_.erase(ruri);
}

void HoldersProcess::Hear(const std::string& ruri) {
  ground_.truth.NoteSign(ruri, ground_.id, fleet_.Find(ruri)->state.held_since());
  HearLate(ruri);
}

void HoldersProcess::Park(const std::string& ruri, SystemTime until) {
  fleet_.Find(ruri)->state.Park(until, ground_.clock.Steady());
}

void HoldersProcess::HearLate(const std::string& ruri) {
  fleet_.Find(ruri)->state.SignOfLife(ground_.clock.Steady(), ground_.clock.System(),
                                      fleet_.presence_limits());
}

void HoldersProcess::Stop() {
  // As run::Drain ends.
  const bool judges = leases_.Leave() == store::LeaseRounds::Left::kToNone ||
                      ground_.fault == HoldersFault::kStopsWithUnknown;
  for (const fleet::RobotPtr& robot : fleet_.Sorted()) {
    if (!judges || robot->state.held_since() == 0) continue;
    if (robot->state.presence() != model::Presence::kOnline) continue;
    shards_.NotePresence(robot->id(), model::Presence::kUnknown, ground_.clock.System(), {},
                         robot->state.parked_until());
  }
  journal_.RequestCheckpoint();
  while (journal_.turns().Advance() == journal::Step::kWorked) {
  }
}

}  // namespace uplink::simulation
