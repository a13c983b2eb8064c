#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>

#include "server/http/probe.h"

namespace uplink::http {

/// Jobs that wait for the reading thread at most.
inline constexpr std::size_t kReadsWaitingMax = 64;

/// One thread that runs what may wait for the store, so that the io thread never does. Jobs must
/// not throw. Thread-safe. The destructor drops what waits and joins.
class ReadThread final {
 public:
  explicit ReadThread(HttpProbe& probe);
  ~ReadThread();
  ReadThread(const ReadThread&) = delete;
  ReadThread& operator=(const ReadThread&) = delete;

  /// False, and the job is not taken, when kReadsWaitingMax wait.
  [[nodiscard]] bool TryPost(std::function<void()> job);

 private:
  void Run(const std::stop_token& stop);

  HttpProbe& probe_;
  std::mutex mutex_;
  std::condition_variable_any work_;
  std::deque<std::function<void()>> jobs_;
  std::jthread thread_;
};

}  // namespace uplink::http
