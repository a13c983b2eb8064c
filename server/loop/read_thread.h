#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>

#include "metrics/cells.h"

namespace uplink::loop {

/// Jobs that wait for a thread at most, if nothing else is said.
inline constexpr std::size_t kReadsWaitingMax = 64;

/// Jobs that go ahead of those and wait, at most.
inline constexpr std::size_t kReadsAheadMax = 1024;

/// How such a thread is called (at most 15 bytes), and how far it gives way to others (0 to 19).
struct ThreadKind {
  const char* name;
  int nice;
};

/// One thread that runs what may wait for the store or takes long, so that the event loop never
/// does. Jobs must not throw. Thread-safe. The destructor drops what waits and joins.
class ReadThread final {
 public:
  /// `waiting` and `refused` count jobs and outlive the thread. `waiting_max`: jobs that wait.
  ReadThread(metrics::Cell& waiting, metrics::Cell& refused, const ThreadKind& kind,
             std::size_t waiting_max = kReadsWaitingMax);
  ~ReadThread();
  ReadThread(const ReadThread&) = delete;
  ReadThread& operator=(const ReadThread&) = delete;

  /// False, and the job is not taken, when `waiting_max` wait.
  [[nodiscard]] bool TryPost(std::function<void()> job);
  /// The same ahead of all that TryPost was given, with a bound of its own (kReadsAheadMax).
  [[nodiscard]] bool TryPostAhead(std::function<void()> job);

 private:
  using Jobs = std::deque<std::function<void()>>;

  [[nodiscard]] bool TryPost(Jobs& jobs, std::size_t jobs_max, std::function<void()> job);
  void Run(const std::stop_token& stop);

  metrics::Cell& waiting_;
  metrics::Cell& refused_;
  const int nice_;
  const std::size_t waiting_max_;
  std::mutex mutex_;
  std::condition_variable_any work_;
  Jobs ahead_;
  Jobs jobs_;
  std::jthread thread_;
};

}  // namespace uplink::loop
