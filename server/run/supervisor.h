#pragma once

#include <functional>
#include <utility>

namespace uplink::run {

/// The service manager that started the process (systemd). It hears how the process fares if it
/// asked for that through the environment.
///
/// Thread-safe.
class Supervisor final {
 public:
  /// Robots can connect.
  static void NoteReady();
  /// The process stops in order.
  static void NoteStopping();
  /// The process is well. A manager that does not hear so for WatchdogSec starts it anew.
  static void NoteAlive();
};

/// Feeds the manager's watchdog while the server is well, and only then.
///
/// Thread: confined to one.
class Watchdog final {
 public:
  struct Context {
    /// Whether robots would be answered.
    std::function<bool()> alive;
    std::function<void()> feed = [] { Supervisor::NoteAlive(); };
  };
  explicit Watchdog(Context context) : context_(std::move(context)) {}

  void Beat() const {
    if (context_.alive()) context_.feed();
  }

 private:
  const Context context_;
};

}  // namespace uplink::run
