#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "schema/base/clock.h"
#include "server/log/logger.h"

namespace uplink::http {

/// The one thread of the server that waits for sockets, signals and timers of its own: HTTP, the
/// presence sweep, the background handshake.
///
/// Jobs run on the loop's thread, must be short, and must not throw.
/// Thread: Every and OnSignals before Start; Stop by the owner. The rest: any thread.
class EventLoop final {
 public:
  explicit EventLoop(const log::Logger& logger);
  /// Stops, then drops what is still queued.
  ~EventLoop();
  EventLoop(const EventLoop&) = delete;
  EventLoop& operator=(const EventLoop&) = delete;

  /// Runs `job` at Start and then after each `interval`; a late run does not shorten the next.
  void Every(milliseconds interval, std::function<void()> job);
  /// Runs `job` with the number of each of these signals from now on.
  void OnSignals(const std::vector<int>& signals, std::function<void(int)> job);
  void Post(std::function<void()> job);

  void Start();
  /// Ends the thread. Idempotent.
  void Stop();

  /// The io_context, for the transports of this folder (asio_context.h).
  struct Context;
  [[nodiscard]] Context& context() { return *context_; }

 private:
  void Run();

  const log::Logger& logger_;
  std::unique_ptr<Context> context_;
};

}  // namespace uplink::http
