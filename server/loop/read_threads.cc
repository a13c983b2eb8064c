#include "server/loop/read_threads.h"

#include <algorithm>
#include <utility>

#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

namespace uplink::loop {

ReadThreads::ReadThreads(metrics::Cell& waiting, metrics::Cell& refused, const ThreadKind& kind,
                         const JobBounds& bounds)
    : waiting_(waiting), refused_(refused), nice_(kind.nice), bounds_(bounds) {
  for (std::size_t i = 0; i < bounds_.threads; ++i) {
    std::jthread& thread =
        threads_.emplace_back([this](const std::stop_token& stop) { Run(stop); });
    pthread_setname_np(thread.native_handle(), kind.name);
  }
}

ReadThreads::~ReadThreads() {
  // All stop at once, not one after another.
  for (std::jthread& thread : threads_) thread.request_stop();
  threads_.clear();
}

std::optional<JobId> ReadThreads::TryPost(std::function<void()> job) {
  return TryPost(jobs_, bounds_.waiting_max, std::move(job));
}

std::optional<JobId> ReadThreads::TryPostAhead(std::function<void()> job) {
  return TryPost(ahead_, bounds_.ahead_max, std::move(job));
}

std::optional<JobId> ReadThreads::TryPost(Jobs& jobs, std::size_t jobs_max,
                                          std::function<void()> run) {
  JobId id = 0;
  {
    const std::lock_guard lock(mutex_);
    if (jobs.size() >= jobs_max) {
      refused_.Add();
      return std::nullopt;
    }
    id = ++posted_;
    jobs.push_back({id, std::move(run)});
    waiting_.Add();
  }
  work_.notify_one();
  return id;
}

void ReadThreads::Withdraw(JobId id) {
  // Ends without the lock: it may hold much.
  std::function<void()> withdrawn;
  const std::lock_guard lock(mutex_);
  for (Jobs* jobs : {&ahead_, &jobs_}) {
    const auto job = std::find_if(jobs->begin(), jobs->end(),
                                  [id](const Job& waiting) { return waiting.id == id; });
    if (job == jobs->end()) continue;
    withdrawn = std::move(job->run);
    jobs->erase(job);
    waiting_.Add(-1);
    return;
  }
}

void ReadThreads::Run(const std::stop_token& stop) {
  // Linux keeps niceness per thread. If it may not be set, the thread runs like the others.
  if (nice_ > 0) setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), nice_);
  while (true) {
    std::function<void()> job;
    {
      std::unique_lock lock(mutex_);
      const auto some = [this] { return !ahead_.empty() || !jobs_.empty(); };
      if (!work_.wait(lock, stop, some) || stop.stop_requested()) return;
      Jobs& first = ahead_.empty() ? jobs_ : ahead_;
      job = std::move(first.front().run);
      first.pop_front();
      waiting_.Add(-1);
    }
    job();
  }
}

}  // namespace uplink::loop
