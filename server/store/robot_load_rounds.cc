#include "server/store/robot_load_rounds.h"

#include <string>
#include <utility>

namespace uplink::store {

void RobotLoadRounds::Begin(const absl::Status& away) {
  if (!away.ok()) return LogUnread(away);
  const auto left_out = loader_.Run(context_.robots_max);
  if (!left_out.ok()) return LogUnread(left_out.status());
  LogLeftOut(*left_out);
}

void RobotLoadRounds::LogUnread(const absl::Status& why) {
  const bool away = absl::IsUnavailable(why) || absl::IsDeadlineExceeded(why);
  if (why == unread_) return;
  unread_ = why;
  context_.logger.Warn(away ? "store_away" : "robots_unread",
                       {{"why", std::string(why.message())}});
}

void RobotLoadRounds::LogLeftOut(std::size_t robots) {
  if (robots == 0) return;
  context_.logger.Warn("robots_left_out",
                       {{"robots", robots}, {"robots_max", context_.robots_max}});
}

void RobotLoadRounds::ReadOn(const loop::Post& post) {
  if (loader_.done() && !restore_.due()) return;
  reads_.PostBy(post, [this] {
    if (!loader_.done()) Read();
    RestoreDue();
  });
}

void RobotLoadRounds::Read() {
  const auto left_out = loader_.Run(context_.robots_max);
  if (!left_out.ok()) return LogUnread(left_out.status());
  context_.logger.Info("robots_read", {{"robots", context_.fleet.size()}});
  LogLeftOut(*left_out);
}

void RobotLoadRounds::RestoreDue() {
  const absl::Status restored = restore_.Run();
  if (restored.ok() != restores_) {
    restores_ = restored.ok();
    if (restores_) {
      context_.logger.Info("restore_works_again", {});
    } else {
      context_.logger.Warn("restore_fails", {{"why", std::string(restored.message())}});
    }
  }
  if (restore_.left_out() == 0) return;
  context_.logger.Warn("live_state_left_out", {{"messages", restore_.left_out()},
                                               {"why", "this version does not pass them"}});
}

}  // namespace uplink::store
