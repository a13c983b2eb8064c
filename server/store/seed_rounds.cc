#include "server/store/seed_rounds.h"

#include <string>
#include <utility>

namespace uplink::store {

absl::Status SeedRounds::Begin(absl::Status away) {
  if (away.ok()) {
    absl::Status seeded = seed_.Run(context_.robots_max);
    if (!absl::IsUnavailable(seeded) && !absl::IsDeadlineExceeded(seeded)) return seeded;
    away = std::move(seeded);
  }
  context_.logger.Warn("store_away", {{"why", std::string(away.message())}});
  return absl::OkStatus();
}

void SeedRounds::ReadOn(const std::function<bool(std::function<void()>)>& post) {
  if ((seed_.done() && !restore_.due()) || reading_.exchange(true)) return;
  const bool posted = post([this] {
    if (!seed_.done()) Read();
    RestoreDue();
    reading_.store(false);
  });
  // Where the queue of reads is full, the next round asks again.
  if (!posted) reading_.store(false);
}

void SeedRounds::Read() {
  const absl::Status read = seed_.Run(context_.robots_max);
  if (read.ok()) {
    context_.logger.Info("robots_read", {{"robots", context_.fleet.size()}});
  } else if (seed_.done()) {
    context_.logger.Error("robots_left_out", {{"why", std::string(read.message())}});
  }
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
