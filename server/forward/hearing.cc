#include "server/forward/hearing.h"

#include <string>
#include <utility>

#include "server/forward/limits.h"

namespace uplink::forward {

Hearing::Hearing(Context context)
    : context_(std::move(context)),
      random_(context_.seed),
      rounds_("forward_hear", [this](const std::stop_token& stop) { return Listen(stop); }) {}

void Hearing::Start() {
  if (context_.signal != nullptr) rounds_.Start();
}

void Hearing::Tell() {
  if (context_.signal != nullptr) context_.signal->Tell();
}

loop::Next Hearing::Listen(const std::stop_token& stop) {
  const std::stop_callback end(stop, [this] { context_.signal->End(); });
  if (!Round().ok()) return {.within = pauses_.Next(random_())};
  pauses_.Reset();
  return {};
}

absl::Status Hearing::Round() {
  // No longer, so that it is soon known that it works again.
  const absl::StatusOr<bool> heard = context_.signal->Wait(kLookEvery);
  Note(heard.status());
  if (!heard.ok()) return heard.status();
  if (*heard) {
    context_.probe.heard.Add();
    context_.wake();
  }
  return absl::OkStatus();
}

void Hearing::Note(const absl::Status& status) {
  context_.probe.deaf.Set(status.ok() ? 0 : 1);
  if (std::exchange(failing_, !status.ok()) == failing_) return;
  if (failing_) {
    context_.logger.Warn("forward_hears_nobody", {{"why", std::string(status.message())}});
  } else {
    context_.logger.Info("forward_hears_again", {});
  }
}

}  // namespace uplink::forward
