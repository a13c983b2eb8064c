#include "server/http/read_thread.h"

#include <utility>

#include <pthread.h>

namespace uplink::http {

ReadThread::ReadThread(HttpProbe& probe)
    : probe_(probe), thread_([this](const std::stop_token& stop) { Run(stop); }) {
  pthread_setname_np(thread_.native_handle(), "http-read");
}

ReadThread::~ReadThread() {
  thread_.request_stop();
  thread_.join();
}

bool ReadThread::TryPost(std::function<void()> job) {
  {
    const std::lock_guard lock(mutex_);
    if (jobs_.size() >= kReadsWaitingMax) {
      probe_.reads_refused.Add();
      return false;
    }
    jobs_.push_back(std::move(job));
    probe_.reads_waiting.Add();
  }
  work_.notify_one();
  return true;
}

void ReadThread::Run(const std::stop_token& stop) {
  while (true) {
    std::function<void()> job;
    {
      std::unique_lock lock(mutex_);
      if (!work_.wait(lock, stop, [this] { return !jobs_.empty(); }) || stop.stop_requested()) {
        return;
      }
      job = std::move(jobs_.front());
      jobs_.pop_front();
      probe_.reads_waiting.Add(-1);
    }
    job();
  }
}

}  // namespace uplink::http
