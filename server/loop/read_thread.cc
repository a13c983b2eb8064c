#include "server/loop/read_thread.h"

#include <utility>

#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

namespace uplink::loop {

ReadThread::ReadThread(metrics::Cell& waiting, metrics::Cell& refused, const ThreadKind& kind,
                       const JobBounds& bounds)
    : waiting_(waiting),
      refused_(refused),
      nice_(kind.nice),
      bounds_(bounds),
      thread_([this](const std::stop_token& stop) { Run(stop); }) {
  pthread_setname_np(thread_.native_handle(), kind.name);
}

ReadThread::~ReadThread() {
  thread_.request_stop();
  thread_.join();
}

bool ReadThread::TryPost(std::function<void()> job) {
  return TryPost(jobs_, bounds_.waiting_max, std::move(job));
}

bool ReadThread::TryPostAhead(std::function<void()> job) {
  return TryPost(ahead_, bounds_.ahead_max, std::move(job));
}

bool ReadThread::TryPost(Jobs& jobs, std::size_t jobs_max, std::function<void()> job) {
  {
    const std::lock_guard lock(mutex_);
    if (jobs.size() >= jobs_max) {
      refused_.Add();
      return false;
    }
    jobs.push_back(std::move(job));
    waiting_.Add();
  }
  work_.notify_one();
  return true;
}

void ReadThread::Run(const std::stop_token& stop) {
  // Linux keeps niceness per thread. If it may not be set, the thread runs like the others.
  if (nice_ > 0) setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), nice_);
  while (true) {
    std::function<void()> job;
    {
      std::unique_lock lock(mutex_);
      const auto some = [this] { return !ahead_.empty() || !jobs_.empty(); };
      if (!work_.wait(lock, stop, some) || stop.stop_requested()) return;
      Jobs& first = ahead_.empty() ? jobs_ : ahead_;
      job = std::move(first.front());
      first.pop_front();
      waiting_.Add(-1);
    }
    job();
  }
}

}  // namespace uplink::loop
