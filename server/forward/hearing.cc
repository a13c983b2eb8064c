#include "server/forward/hearing.h"

#include <string>
#include <utility>

#include <pthread.h>

#include "server/forward/limits.h"

namespace uplink::forward {

Hearing::Hearing(Context context) : context_(std::move(context)), random_(context_.seed) {}

void Hearing::Start() {
  if (context_.signal == nullptr) return;
  thread_ = std::jthread([this](const std::stop_token& stop) { Run(stop); });
  ::pthread_setname_np(thread_.native_handle(), "forward_hear");
}

void Hearing::Stop() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  context_.signal->End();
  thread_.join();
}

void Hearing::Tell() {
  if (context_.signal != nullptr) context_.signal->Tell();
}

void Hearing::Run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    if (Round().ok()) {
      pauses_.Reset();
      continue;
    }
    std::unique_lock lock(mutex_);
    stopped_.wait_for(lock, stop, pauses_.Next(random_()), [] { return false; });
  }
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
