#pragma once

#include <cstdint>
#include <functional>
#include <random>
#include <stop_token>

#include <absl/status/status.h>

#include "schema/base/backoff.h"
#include "server/forward/probe.h"
#include "server/log/logger.h"
#include "server/loop/rounds.h"
#include "storage/change_signal.h"

namespace uplink::forward {

/// Hears that another server committed, and tells the others of commits of this one.
///
/// It only makes changes come sooner: while it cannot hear, Rounds finds them each kLookEvery. So a
/// failure is logged and counted, and is no reason to call the server degraded.
///
/// Thread: Tell from any; Round by one thread at a time: Start gives it one of its own.
class Hearing final {
 public:
  /// The references, and the signal, outlive it.
  struct Context {
    const log::Logger& logger;
    ForwardProbe& probe;
    /// Null where one process has the store: then there is nobody to hear.
    storage::ChangeSignal* signal = nullptr;
    /// Called once another server told; any thread.
    std::function<void()> wake;
    /// For the pauses between tries.
    std::uint64_t seed = 0;
  };
  explicit Hearing(Context context);
  Hearing(const Hearing&) = delete;
  Hearing& operator=(const Hearing&) = delete;

  void Start();
  /// Waits at most for a call to the store that is under way.
  void Stop() { rounds_.Stop(); }
  /// Something was committed that may be shared.
  void Tell();
  /// Listens for kLookEvery, or until another server tells.
  absl::Status Round();

 private:
  loop::Next Listen(const std::stop_token& stop);
  void Note(const absl::Status& status);

  const Context context_;
  bool failing_ = false;
  Backoff pauses_{BackoffLimits()};
  std::mt19937_64 random_;
  loop::Rounds rounds_;
};

}  // namespace uplink::forward
