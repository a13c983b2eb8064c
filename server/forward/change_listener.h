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

/// Listens for the commits of other servers, and tells them of this server's commits.
///
/// It only makes changes come sooner: while it fails, Rounds finds them each kLookEvery. A failure
/// is therefore logged and shown, and does not make the server degraded.
///
/// Thread: Tell from any; Round by one thread at a time. Start runs it on a thread of its own.
class ChangeListener final {
 public:
  /// The references, and the signal, outlive it.
  struct Context {
    const log::Logger& logger;
    ForwardProbe& probe;
    /// Null if this process has the store alone.
    storage::ChangeSignal* signal = nullptr;
    /// Called when another server has announced a commit; any thread.
    std::function<void()> wake;
    /// For the pauses between tries.
    std::uint64_t seed = 0;
  };
  explicit ChangeListener(Context context);
  ChangeListener(const ChangeListener&) = delete;
  ChangeListener& operator=(const ChangeListener&) = delete;

  void Start();
  /// Waits only for a call to the store that is under way.
  void Stop() { rounds_.Stop(); }
  /// This server committed something that may be shared.
  void Tell();
  /// Listens for kLookEvery, or until another server tells of a commit.
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
