#pragma once

#include <functional>

#include <absl/status/status.h>

namespace uplink::run {

/// The steps of the way up, once all parts are constructed and connected. HTTP listens already, and
/// answers that the server starts.
struct StartSteps {
  /// Takes over the robots that the store knows; one that is away is waited for later.
  std::function<void()> read_robots;
  /// Commits what comes from now on.
  std::function<void()> start_writers;
  /// Admits robots from now on.
  std::function<absl::Status()> listen_for_robots;
  /// Answers scrapes and queries from now on.
  std::function<void()> answer_http;
  /// Tells operators and the service manager that the server is ready.
  std::function<void()> tell_ready;
  /// Does what is due from now on. The first beat of the service manager's watchdog is part of it,
  /// so that the manager hears READY=1 first.
  std::function<void()> begin_work;
};

/// Starts the server, in the order of the steps: whatever a step lets in, those before it can take.
///
/// Errors: of the first step that fails; none after it is begun, and the caller stops what was.
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
