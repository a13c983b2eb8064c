#include "server/run/deadline.h"

#include <stop_token>
#include <utility>

#include <pthread.h>

namespace uplink::run {

Deadline::Deadline(milliseconds wait, std::function<void()> late)
    : thread_([this, wait, act = std::move(late)](const std::stop_token& stop) {
        std::unique_lock lock(mutex_);
        over_.wait_for(lock, stop, wait, [] { return false; });
        if (!stop.stop_requested()) act();
      }) {
  pthread_setname_np(thread_.native_handle(), "deadline");
}

Deadline::~Deadline() {
  thread_.request_stop();
  thread_.join();
}

}  // namespace uplink::run
