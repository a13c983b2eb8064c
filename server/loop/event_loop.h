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

/// The one thread of the server that waits for sockets, signals and timers: those of HTTP, of the
/// presence sweep, of the background handshake.
///
/// Jobs run on the loop's thread, must be short, and must not throw.
/// Thread: Every and OnSignals before Start, or on the loop's; Stop by the owner. The rest: any
/// thread.
class EventLoop final {
 public:
  explicit EventLoop(const log::Logger& logger);
  /// Stops, then drops what is still queued.
  ~EventLoop();
  EventLoop(const EventLoop&) = delete;
  EventLoop& operator=(const EventLoop&) = delete;

  /// Runs `job` at once, or at Start, and then after each `interval`; a late run does not shorten
  /// the next.
  void Every(milliseconds interval, std::function<void()> job);
  /// Runs `job` with the number of each of these signals from now on.
  void OnSignals(const std::vector<int>& signals, std::function<void(int)> job);
  /// Runs `job` after all jobs that were posted before it, by whatever thread.
  void Post(std::function<void()> job);

  void Start();
  /// Ends the thread. Idempotent.
  void Stop();

  /// For those who wait for sockets on this thread: the handshake probe and HTTP.
  [[nodiscard]] boost::asio::io_context& io();

 private:
  struct Context;

  void Run();

  const log::Logger& logger_;
  std::unique_ptr<Context> context_;
};

}  // namespace uplink::loop
