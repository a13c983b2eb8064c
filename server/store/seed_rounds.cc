#include "server/store/seed_rounds.h"

#include <string>
#include <utility>

namespace uplink::store {

void SeedRounds::Begin(const absl::Status& away) {
  if (!away.ok()) return LogUnread(away);
  const auto left_out = seed_.Run(context_.robots_max);
  if (!left_out.ok()) return LogUnread(left_out.status());
  LogLeftOut(*left_out);
}

void SeedRounds::LogUnread(const absl::Status& why) {
  const bool away = absl::IsUnavailable(why) || absl::IsDeadlineExceeded(why);
  if (why == unread_) return;
  unread_ = why;
  context_.logger.Warn(away ? "store_away" : "robots_unread",
                       {{"why", std::string(why.message())}});
}

void SeedRounds::LogLeftOut(std::size_t robots) {
  if (robots == 0) return;
  context_.logger.Warn("robots_left_out",
                       {{"robots", robots}, {"robots_max", context_.robots_max}});
}

void SeedRounds::ReadOn(const loop::Post& post) {
  if (seed_.done() && !restore_.due()) return;
  reads_.PostBy(post, [this] {
    if (!seed_.done()) Read();
    RestoreDue();
  });
}

void SeedRounds::Read() {
  const auto left_out = seed_.Run(context_.robots_max);
  if (!left_out.ok()) return LogUnread(left_out.status());
  context_.logger.Info("robots_read", {{"robots", context_.fleet.size()}});
  LogLeftOut(*left_out);
}

void SeedRounds::RestoreDue() {
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
