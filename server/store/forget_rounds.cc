#include "server/store/forget_rounds.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace uplink::store {

using storage::ForgetAnswer;

namespace {

/// Calls of a robot to forget are accepted again after so long: by then it is forgotten, or was
/// asked for anew.
constexpr std::chrono::seconds kCallsEndFor{5};

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

ForgetRounds::ForgetRounds(Context context)
    : context_(std::move(context)),
      silent_rows_({.fleet = context_.fleet,
                    .clock = context_.clock,
                    .logger = context_.logger,
                    .removal = context_.store.removal(),
                    .process = context_.process,
                    .rule = context_.rows,
                    .trust = context_.trust}),
      rounds_("forget", [this](const auto& /*stop*/) { return loop::Next{.within = Round()}; }) {}

milliseconds ForgetRounds::Round() {
  const absl::StatusOr<Look> look = LookAtAll();
  NoteOutcome(look.ok() ? silent_rows_.Round() : look.status());
  if (!look.ok()) return kLookAgainEvery;
  return *look == Look::kUnderWay ? kLookAtLeavingEvery : kLookForForgottenEvery;
}

absl::StatusOr<ForgetRounds::Look> ForgetRounds::LookAtAll() {
  const auto pending = context_.store.requests().Pending();
  if (!pending.ok()) return pending.status();
  Look all = Look::kDone;
  std::erase_if(told_, [&pending](std::uint64_t number) {
    return std::ranges::none_of(
        *pending, [number](const storage::PendingForget& asked) { return asked.number == number; });
  });
  for (const storage::PendingForget& asked : *pending) {
    absl::StatusOr<Look> look = LookAt(asked);
    if (!look.ok()) return look;
    if (*look == Look::kUnderWay) all = Look::kUnderWay;
  }
  first_look_ = false;
  // Robots that the journal has let go of since.
  if (all == Look::kUnderWay) static_cast<void>(context_.fleet.RemoveLeft());
  return all;
}

void ForgetRounds::NoteOutcome(const absl::Status& status) {
  const bool fails = !status.ok();
  if (fails == failing_) return;
  failing_ = fails;
  if (fails) {
    context_.logger.Warn("forget_fails", {{"why", std::string(status.message())}});
  } else {
    context_.logger.Info("forget_works_again", {});
  }
}

absl::StatusOr<ForgetRounds::Look> ForgetRounds::LookAt(const storage::PendingForget& asked) {
  if (asked.finished) return Follow(asked);
  if (!asked.hold) return Look::kDone;
  // In a store of one process, the previous holder has ended.
  if (!context_.alone && asked.hold->owner != context_.process) return Look::kDone;
  // After reading the epoch: a stream that is not visible here has a later one.
  const fleet::RobotPtr robot = context_.fleet.Find(asked.ruri);
  if (robot == nullptr) return Tell(asked, ForgetAnswer::kLetGo);
  return LetGo(asked, *robot);
}

absl::StatusOr<ForgetRounds::Look> ForgetRounds::LetGo(const storage::PendingForget& asked,
                                                       robot::Robot& robot) {
  if (robot.speaks()) {
    if (!asked.end_stream) return Tell(asked, ForgetAnswer::kHasStream);
    robot.sessions.EndStream().Wake();
    robot.calls.AskToEnd(context_.clock.Steady() + kCallsEndFor);
    return Look::kUnderWay;
  }
  if (robot.sessions.in_flight() > 0) {
    return asked.end_stream ? Look::kUnderWay : Tell(asked, ForgetAnswer::kRecordsWait);
  }
  // If it stays in the store after all, it must not be online there for ever.
  robot.state.ForgetSigns(
      context_.clock.Steady() + context_.fleet.presence_limits_of(robot).timeout,
      context_.clock.System());
  Leave(robot);
  return Look::kUnderWay;
}

absl::StatusOr<ForgetRounds::Look> ForgetRounds::Tell(const storage::PendingForget& asked,
                                                      ForgetAnswer answer) {
  const storage::Epoch epoch = answer == ForgetAnswer::kLetGo ? asked.hold->epoch : 0;
  // If it fails, the request is found again.
  absl::Status answered = context_.store.requests().Answer(asked.number, {answer, epoch});
  if (!answered.ok()) return answered;
  context_.logger.Info("forget_answered", {{"ruri", asked.ruri}, {"answer", NameOf(answer)}});
  return Look::kDone;
}

ForgetRounds::Look ForgetRounds::Follow(const storage::PendingForget& asked) {
  const bool is_gone = !asked.hold;  // otherwise it stayed, or is there again
  if (told_.insert(asked.number).second && !first_look_) {
    if (is_gone || asked.removed) {
      context_.logger.Info("robot_removed", {{"ruri", asked.ruri}, {"came_back", !is_gone}});
    } else {
      context_.logger.Info("forget_given_up", {{"ruri", asked.ruri}});
    }
  }
  if (!is_gone) return Look::kDone;
  const fleet::RobotPtr robot = context_.fleet.Find(asked.ruri);
  if (robot == nullptr) return Look::kDone;
  if (robot->speaks()) {
    OpenAnew(*robot);
    return Look::kDone;
  }
  if (!robot->idle()) return Look::kDone;
  Leave(*robot);
  return Look::kUnderWay;
}

void ForgetRounds::OpenAnew(robot::Robot& robot) {
  // A stream that is about to open holds nothing yet.
  const storage::Epoch held_since = robot.state.held_since();
  if (held_since == 0) return;
  context_.journals.Lose({.client = &robot, .robot = robot.id(), .since = held_since + 1});
}

void ForgetRounds::Leave(robot::Robot& robot) {
  // The journal has let go of it. Asking once more would queue it in the journal again, where
  // entries refer to the robot.
  if (robot.left()) return;
  context_.fleet.BeginLeaving(robot, robot::Robot::LeaveWhen::kAtOnce);
  context_.journals.Leave({&robot, robot.id()});
}

}  // namespace uplink::store
