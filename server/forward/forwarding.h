#pragma once

#include <cstdint>

#include "metrics/exposition.h"
#include "server/forward/change_listener.h"
#include "server/forward/forwards.h"
#include "server/forward/probe.h"
#include "server/forward/rounds.h"

namespace uplink::forward {

/// All of forwarding in one server: what its robots share, the thread that follows the store, and
/// the thread that listens for other servers.
///
/// Thread: Start and Stop by main; source() is for the listener; the rest from any.
class Forwarding final {
 public:
  /// The references outlive it.
  struct Context {
    const Clock& clock;
    const log::Logger& logger;
    storage::SharedItems& items;
    const storage::ClockTrust& clock_trust;
    /// For the numbers of commands.
    std::uint64_t seed = 0;
    /// Null where one process has the store; outlives it.
    storage::ChangeSignal* change_signal = nullptr;
  };
  explicit Forwarding(const Context& context);

  void Start() {
    rounds_.Start();
    listener_.Start();
  }
  void Stop() {
    listener_.Stop();
    rounds_.Stop();
  }
  /// This server committed something that may be shared.
  void Wake() {
    rounds_.Wake();
    listener_.Tell();
  }
  /// Where streams receive from.
  [[nodiscard]] session::ForwardSource& source() { return forwards_; }
  /// Receivers lack something: the items were not all read yet, changes cannot be read now, some
  /// items have no room, or some cannot be read.
  [[nodiscard]] bool incomplete() const {
    return !forwards_.whole() || probe_.failing.value() != 0 || forwards_.left_out() ||
           probe_.unreadable_now.value() != 0;
  }
  /// What is shared and what became of its changes, for a page of metrics: due is the sum of
  /// settled and waiting in each text.
  void AddSamples(metrics::Exposition& page) const;

 private:
  const Clock& clock_;
  ForwardProbe probe_;
  Forwards forwards_;
  Rounds rounds_;
  ChangeListener listener_;
};

}  // namespace uplink::forward
