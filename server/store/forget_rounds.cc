#include "server/store/forget_rounds.h"

#include <algorithm>
#include <string>
#include <vector>

#include <pthread.h>

namespace uplink::store {

using storage::ForgetAnswer;

namespace {

const char* NameOf(ForgetAnswer answer) {
  switch (answer) {
    case ForgetAnswer::kNone:
      return "none";
    case ForgetAnswer::kLetGo:
      return "let_go";
    case ForgetAnswer::kHasStream:
      return "has_stream";
    case ForgetAnswer::kRecordsWait:
      return "records_wait";
  }
  return "";
}

}  // namespace

milliseconds ForgetRounds::Round() {
  RemoveSilent();
  const auto pending = context_.removal.Pending();
  if (!pending.ok()) return kLookAgainEvery;
  bool under_way = false;
  for (const storage::PendingForget& asked : *pending) {
    if (LookAt(asked) == Look::kUnderWay) under_way = true;
  }
  if (!under_way) return kLookForForgottenEvery;
  // Those of whom the journal has let go since.
  static_cast<void>(context_.fleet.RemoveLeft());
  return kLookAtLeavingEvery;
}

ForgetRounds::Look ForgetRounds::LookAt(const storage::PendingForget& asked) {
  if (asked.finished) return Follow(asked);
  if (!asked.hold || asked.hold->owner != context_.process) return Look::kDone;
  // After the epoch was read: a stream that is not seen here has a later one.
  const fleet::RobotPtr robot = context_.fleet.Find(asked.ruri);
  if (robot == nullptr) return Tell(asked, ForgetAnswer::kLetGo);
  return LetGo(asked, *robot);
}

ForgetRounds::Look ForgetRounds::LetGo(const storage::PendingForget& asked, robot::Robot& robot) {
  if (robot.HasStream()) {
    if (!asked.end_stream) return Tell(asked, ForgetAnswer::kHasStream);
    robot.sessions.EndStream().Wake();
    return Look::kUnderWay;
  }
  if (robot.sessions.in_flight() > 0) {
    return asked.end_stream ? Look::kUnderWay : Tell(asked, ForgetAnswer::kRecordsWait);
  }
  // Should it stay in the store after all, it is not online there for ever.
  if (robot.state.presence() == model::Presence::kOnline && !robot.leaving()) {
    context_.journals.NotePresence(robot.id(), model::Presence::kUnknown, context_.clock.System());
  }
  Leave(robot);
  return Look::kUnderWay;
}

ForgetRounds::Look ForgetRounds::Tell(const storage::PendingForget& asked, ForgetAnswer answer) {
  const storage::Epoch epoch = answer == ForgetAnswer::kLetGo ? asked.hold->epoch : 0;
  context_.logger.Info("forget_answered", {{"ruri", asked.ruri}, {"answer", NameOf(answer)}});
  // Where it fails, the request is found again.
  static_cast<void>(context_.removal.Answer(asked.number, {answer, epoch}));
  return Look::kDone;
}

ForgetRounds::Look ForgetRounds::Follow(const storage::PendingForget& asked) {
  if (asked.hold) return Look::kDone;  // it stayed, or is there again
  const fleet::RobotPtr robot = context_.fleet.Find(asked.ruri);
  // A stream of it is here, and opens it anew.
  if (robot == nullptr || !robot->idle()) return Look::kDone;
  Leave(*robot);
  return Look::kUnderWay;
}

void ForgetRounds::Leave(robot::Robot& robot) {
  // Asked once more, the journal would keep it.
  if (robot.left()) return;
  context_.fleet.BeginLeaving(robot, robot::Robot::LeaveWhen::kAtOnce);
  context_.journals.Leave({&robot, robot.id()});
}

void ForgetRounds::RemoveSilent() {
  const SteadyTime now = context_.clock.Steady();
  if (removed_silent_ && now - *removed_silent_ < kRemoveSilentEvery) return;
  const std::optional<SystemTime> until = context_.rows.Until(context_.clock.System());
  if (!until || !context_.trust.vouched()) return;
  const auto silent = context_.removal.SilentSince(*until, context_.process);
  if (!silent.ok()) return;
  std::size_t removed = 0;
  for (const storage::SilentRobot& robot : *silent) {
    if (context_.fleet.Find(robot.ruri) != nullptr) continue;
    const auto gone = context_.removal.Remove(robot.ruri, robot.epoch);
    if (!gone.ok()) return;
    if (*gone) ++removed;
  }
  if (removed > 0) context_.logger.Info("silent_robots_removed", {{"robots", removed}});
  // As many as one answer names: there may be more.
  if (removed < storage::kSilentRobotsMax) removed_silent_ = now;
}

void ForgetRounds::Start() {
  thread_ = std::jthread([this](const std::stop_token& stop) { Run(stop); });
  ::pthread_setname_np(thread_.native_handle(), "forget");
}

void ForgetRounds::Stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

void ForgetRounds::Run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    const milliseconds pause = Round();
    std::unique_lock lock(mutex_);
    pause_.wait_for(lock, stop, pause, [] { return false; });
  }
}

std::optional<SystemTime> RowsRule::Until(SystemTime now) const {
  if (forget_after.count() == 0 || retain_history.count() == 0 || retain_quarantine.count() == 0) {
    return std::nullopt;
  }
  // A day more: others may have it in memory until then.
  return now - std::max({forget_after, retain_history, retain_quarantine}) - std::chrono::days(1);
}

RowsRule RowsRuleOf(const config::Config& config) {
  return {.forget_after = config.fleet.forget_after,
          .retain_history = config.store.retain_history,
          .retain_quarantine = config.store.retain_quarantine};
}

}  // namespace uplink::store
