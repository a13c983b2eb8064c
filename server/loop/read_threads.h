#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <vector>

#include "metrics/cells.h"

namespace uplink::loop {

/// Jobs that may wait for a thread, by default.
inline constexpr std::size_t kReadsWaitingMax = 64;

/// Jobs that may wait ahead of those (TryPostAhead).
inline constexpr std::size_t kReadsAheadMax = 1024;

/// How many jobs may wait, and how many run side by side.
struct JobBounds {
  std::size_t waiting_max = kReadsWaitingMax;
  std::size_t ahead_max = kReadsAheadMax;
  /// Threads that share the queue, at least one. One runs the jobs in their order.
  std::size_t threads = 1;
};

/// The name of such threads (at most 15 bytes), and their niceness (0 to 19).
struct ThreadKind {
  const char* name;
  int nice;
};

/// A job of one ReadThreads.
using JobId = std::uint64_t;

/// Threads for jobs that may wait for the store or take long, so that the event loop never does.
/// Jobs must not throw. Thread-safe. The destructor drops waiting jobs and joins.
class ReadThreads final {
 public:
  /// `waiting` and `refused` count jobs and outlive the threads.
  ReadThreads(metrics::Cell& waiting, metrics::Cell& refused, const ThreadKind& kind,
              const JobBounds& bounds = JobBounds());
  ~ReadThreads();
  ReadThreads(const ReadThreads&) = delete;
  ReadThreads& operator=(const ReadThreads&) = delete;

  /// Nothing if JobBounds::waiting_max jobs wait: then the job is dropped.
  [[nodiscard]] std::optional<JobId> TryPost(std::function<void()> job);
  /// The same, ahead of all jobs of TryPost, with a bound of its own (ahead_max).
  [[nodiscard]] std::optional<JobId> TryPostAhead(std::function<void()> job);
  /// Drops the job if it still waits, and with it what it holds, in the caller's thread.
  void Withdraw(JobId id);

 private:
  struct Job {
    JobId id = 0;
    std::function<void()> run;
  };
  using Jobs = std::deque<Job>;

  [[nodiscard]] std::optional<JobId> TryPost(Jobs& jobs, std::size_t jobs_max,
                                             std::function<void()> run);
  void Run(const std::stop_token& stop);

  metrics::Cell& waiting_;
  metrics::Cell& refused_;
  const int nice_;
  const JobBounds bounds_;
  std::mutex mutex_;
  std::condition_variable_any work_;
  JobId posted_ = 0;
  Jobs ahead_;
  Jobs jobs_;
  std::vector<std::jthread> threads_;
};

}  // namespace uplink::loop
