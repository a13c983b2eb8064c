#pragma once

#include <functional>

#include "schema/base/clock.h"

namespace uplink::run {

/// What the server does again and again while it runs. Each job is short: what may take long it
/// posts to another thread.
struct PeriodicWork {
  /// The presence sweep.
  std::function<void()> sweep;
  /// Looks whether the relay's certificate files were replaced, and when the certificate expires.
  std::function<void()> look_at_certificate;
  /// Looks whether the files of HTTP's tokens and TLS were replaced.
  std::function<void()> look_at_access;
  /// Looks at the store's last error, for the log.
  std::function<void()> look_at_store;
  /// Reads the robots, if the store was away at the start, and the state of those that this process
  /// began to hold.
  std::function<void()> read_robots;
  /// Asks the store for the oldest snapshot.
  std::function<void()> ask_for_snapshot;
  /// Looks at how much the store's disk has left.
  std::function<void()> look_at_space;
  /// Judges the civil clock, and keeps the store's mark.
  std::function<void()> look_at_clock;
  /// Counts the robots' active faults, for their series.
  std::function<void()> count_faults;
  /// Adds what the robots have sent since the last look.
  std::function<void()> look_at_top;
  /// Lets go of drones that are silent.
  std::function<void()> look_at_drones;
  /// Asks our own relay for a handshake.
  std::function<void()> ask_relay;
  /// Looks whether the configuration file was changed.
  std::function<void()> look_at_config;
  /// Writes the rows of the audit that wait.
  std::function<void()> write_audit;
  /// Tells the service manager that the server is well.
  std::function<void()> feed_watchdog;
};

/// Gives `every` each job with its interval; `every` runs the job at once and then at that
/// interval.
void DoPeriodically(const std::function<void(milliseconds, std::function<void()>)>& every,
                    PeriodicWork work);

}  // namespace uplink::run
