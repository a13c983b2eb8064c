#include "server/forward/change_listener.h"

#include <string>
#include <utility>

#include "server/forward/limits.h"

namespace uplink::forward {

ChangeListener::ChangeListener(Context context)
    : context_(std::move(context)),
      random_(context_.seed),
      rounds_("forward_listen", [this](const std::stop_token& stop) { return Listen(stop); }) {}

void ChangeListener::Start() {
  if (context_.signal != nullptr) rounds_.Start();
}

void ChangeListener::Tell() {
  if (context_.signal != nullptr) context_.signal->Tell();
}

loop::Next ChangeListener::Listen(const std::stop_token& stop) {
  const std::stop_callback end(stop, [this] { context_.signal->End(); });
  if (!Round().ok()) return {.within = pauses_.Next(random_())};
  pauses_.Reset();
  return {};
}

absl::Status ChangeListener::Round() {
  // A longer wait would show later that it works again.
  const absl::StatusOr<bool> heard = context_.signal->Wait(kLookEvery);
  Note(heard.status());
  if (!heard.ok()) return heard.status();
  if (*heard) {
    context_.probe.heard.Add();
    context_.wake();
  }
  return absl::OkStatus();
}

void ChangeListener::Note(const absl::Status& status) {
  context_.probe.listen_failing.Set(status.ok() ? 0 : 1);
  if (std::exchange(failing_, !status.ok()) == failing_) return;
  if (failing_) {
    context_.logger.Warn("forward_listen_failed", {{"why", std::string(status.message())}});
  } else {
    context_.logger.Info("forward_hears_again", {});
  }
}

}  // namespace uplink::forward
