#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "schema/base/clock.h"
#include "server/log/logger.h"

namespace boost::asio {
class io_context;
}  // namespace boost::asio

namespace uplink::loop {

/// A thread that waits for sockets, signals and timers. The thread `io` has those of HTTP, of the
/// presence sweep, of the handshake probe.
///
/// Jobs run on the loop's thread, must be short, and must not throw.
/// Thread: Every and OnSignals before Start, or on the loop's; Stop by the owner. The rest: any
/// thread.
class EventLoop final {
 public:
  /// `name`: the thread's, at most 15 bytes.
  explicit EventLoop(const log::Logger& logger, const char* name = "io");
  /// Stops, then drops what is still queued.
  ~EventLoop();
  EventLoop(const EventLoop&) = delete;
  EventLoop& operator=(const EventLoop&) = delete;

  /// Runs `job` at once, or at Start, and then after each `interval`. The next interval counts from
  /// the run, even a late one.
  void Every(milliseconds interval, std::function<void()> job);
  /// From now on, runs `job` with the number of each of these signals that comes.
  void OnSignals(const std::vector<int>& signals, std::function<void(int)> job);
  /// Runs `job` after all jobs that any thread posted before it.
  void Post(std::function<void()> job);

  void Start();
  /// Ends the thread. Idempotent.
  void Stop();

  /// For parts that wait for sockets on this thread: the handshake probe and HTTP.
  [[nodiscard]] boost::asio::io_context& io();

 private:
  struct Context;

  void Run();

  const log::Logger& logger_;
  const char* const name_;
  std::unique_ptr<Context> context_;
};

}  // namespace uplink::loop
