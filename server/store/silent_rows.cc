#include "server/store/silent_rows.h"

#include <algorithm>
#include <cstddef>
#include <string>

namespace uplink::store {

absl::Status SilentRows::Round() {
  const SteadyTime now = context_.clock.Steady();
  if (due_ && now < *due_) return outcome_;
  outcome_ = absl::OkStatus();
  const SystemTime civil = context_.clock.System();
  const std::optional<SystemTime> until = context_.rule.Until(civil);
  if (!until || !context_.trust.VouchesFor(civil)) return outcome_;
  const absl::StatusOr<Left> left = RemoveSome(*until);
  outcome_ = left.status();
  if (!left.ok()) {
    due_ = now + kRemoveSilentAgainAfter;
  } else if (*left == Left::kNothing) {
    due_ = now + kRemoveSilentEvery;
  }
  return outcome_;
}

absl::StatusOr<SilentRows::Left> SilentRows::RemoveSome(SystemTime until) {
  const auto silent = context_.removal.SilentSince(until, context_.process, after_);
  if (!silent.ok()) return silent.status();
  std::size_t removed = 0;
  std::string first;
  absl::Status status;
  for (const storage::SilentRobot& robot : *silent) {
    if (context_.fleet.Find(robot.ruri) == nullptr) {
      const auto gone = context_.removal.Remove(robot.ruri, robot.epoch);
      status = gone.status();
      if (!status.ok()) break;
      if (gone->has_value() && removed++ == 0) first = robot.ruri;
    }
    after_ = robot.ruri;
  }
  if (removed > 0) {
    context_.logger.Info("silent_robots_removed", {{"robots", removed}, {"first", first}});
  }
  if (!status.ok()) return status;
  // By the robots in the answer: those that stay count as well.
  if (silent->size() == storage::kSilentRobotsMax) return Left::kMore;
  after_.clear();
  return Left::kNothing;
}

std::optional<SystemTime> RowsRule::Until(SystemTime now) const {
  const auto kept = {forget_after, retain_history, retain_quarantine, retain_connections};
  if (std::ranges::find(kept, milliseconds(0)) != kept.end()) return std::nullopt;
  // A day more, since others may have it in memory until then.
  return now - std::max(kept) - std::chrono::days(1);
}

RowsRule RowsRuleOf(const config::Config& config) {
  return {.forget_after = config.fleet.forget_after,
          .retain_history = config.store.retain_history,
          .retain_quarantine = config.store.retain_quarantine,
          .retain_connections = config.store.retain_connections};
}

}  // namespace uplink::store
