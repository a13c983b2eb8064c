#include "server/loop/rounds.h"

#include <algorithm>
#include <utility>

#include <pthread.h>

namespace uplink::loop {

Rounds::Rounds(std::string name, Round round) : name_(std::move(name)), round_(std::move(round)) {}

void Rounds::Start() {
  thread_ = std::jthread([this](const std::stop_token& stop) { Run(stop); });
}

void Rounds::Stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

void Rounds::Wake() {
  {
    const std::lock_guard lock(mutex_);
    if (std::exchange(woken_, true)) return;
  }
  wake_.notify_one();
}

void Rounds::Run(const std::stop_token& stop) {
  ::pthread_setname_np(pthread_self(), name_.c_str());
  while (!stop.stop_requested()) {
    const Next next = round_(stop);
    std::unique_lock lock(mutex_);
    const SteadyTime::duration first =
        std::max(std::min(next.not_before, next.within), SteadyTime::duration::zero());
    // Even a wait of zero length yields the processor.
    if (first > SteadyTime::duration::zero()) {
      wake_.wait_for(lock, stop, first, [] { return false; });
    }
    if (next.within > first) {
      wake_.wait_for(lock, stop, next.within - first, [this] { return woken_; });
    }
    woken_ = false;
  }
}

}  // namespace uplink::loop
