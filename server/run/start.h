#pragma once

#include <functional>

#include <absl/status/status.h>

namespace uplink::run {

/// The steps of the way up, once all parts are constructed and connected. HTTP listens already, and
/// answers that the server starts.
struct StartSteps {
  /// Takes over the robots that the store knows; if the store is away, later.
  std::function<void()> read_robots;
  /// Commits what comes from now on.
  std::function<void()> start_writers;
  /// Admits robots from now on.
  std::function<absl::Status()> listen_for_robots;
  /// Answers scrapes and queries from now on.
  std::function<void()> answer_http;
  /// Tells operators and the service manager that the server is ready.
  std::function<void()> tell_ready;
  /// Begins the periodic work. It comes last because it feeds the service manager's watchdog, and
  /// the manager must hear READY=1 first.
  std::function<void()> begin_work;
};

/// Starts the server, in the order of the steps: each relies on those before it.
///
/// Errors: of listen_for_robots: the steps after it are left out then, and the caller stops the
///         rest.
/// Thread: main.
[[nodiscard]] absl::Status Start(const StartSteps& steps);

/// The steps of the way down. Each does nothing for a part that was not started.
struct StopSteps {
  /// Ends the streams that are left.
  std::function<void()> stop_relay;
  /// Ends the writers, after the calls of the store that are under way.
  std::function<void()> stop_writers;
  /// Ends the timers and the answers of HTTP.
  std::function<void()> stop_loop;
  /// Ends the threads that wait for the store or write long texts.
  std::function<void()> end_readers;
};

/// Stops the server, in the order of the steps: no robot is heard any more, then nothing is written
/// any more, then the loop ends, and with it HTTP, which answers until then.
///
/// Thread: main.
void Stop(const StopSteps& steps);

}  // namespace uplink::run
