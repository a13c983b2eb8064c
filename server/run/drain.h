#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "server/fleet/fleet.h"
#include "server/health/monitor.h"
#include "server/journal/shards.h"
#include "server/log/logger.h"
#include "server/run/stop_signal.h"

namespace uplink::run {

/// The time after drain.timeout for ending what is left: streams, the commit under way.
inline constexpr std::chrono::seconds kStopWait{5};

/// The time for the log's last lines if nothing reads them.
inline constexpr milliseconds kLogEndWait = 2 * log::kFlushWait;

/// From the end of drain.timeout to the exit, at most. The unit's TimeoutStopSec, the chart and the
/// compose files wait longer (docs/operate/server.md).
inline constexpr milliseconds kExitWait = kStopWait + kLogEndWait;

/// The least time in which a drain commits what waits, however long the streams took.
inline constexpr std::chrono::seconds kLastWrites{2};

/// The way down: no stream is admitted, those that are here end, what waits is committed, and the
/// rest of the server stops. It takes the timeout at most, then kStopWait to end what is left, and
/// counts what is unsettled then in a warning. A store that shuts this program out commits nothing
/// any more: then the timeout is kLastWrites.
///
/// Thread: main.
class Drain final {
 public:
  /// What a drain asks of the robots' transport.
  struct Transport {
    /// Streams that have not ended.
    std::function<std::size_t()> streams;
    /// Admits no stream any more and tells those that are here, within a part of the time.
    std::function<void(milliseconds)> drain;
    /// Waits until every stream has ended, for so long at most; true if they have.
    std::function<bool(milliseconds)> wait_for_streams;
  };
  /// The references outlive it.
  struct Context {
    const Clock& clock;
    log::Logger& logger;
    const metrics::LedgerBook& ledgers;
    const fleet::Fleet& fleet;
    const journal::Shards& journals;
    health::Monitor& monitor;
    StopSignal& signal;
    Transport transport;
    /// Releases this process's robots; true if there is another process that takes them over.
    std::function<bool()> leave;
    /// Takes no robot of another process over from now on.
    std::function<void()> stop_adopting;
    /// Reads nothing more of the broker.
    std::function<void()> drain_broker = [] {};
    /// Takes leave of it once what waits is committed, after a short while at most.
    std::function<void()> leave_broker = [] {};
    /// Stops everything, at the end.
    std::function<void()> stop;
    milliseconds timeout{0};
  };
  explicit Drain(Context context);

  /// Once, after the signal.
  void Run();

 private:
  /// What the streams and the journals have from now on.
  [[nodiscard]] milliseconds Timeout() const;
  /// Notes presence unknown for robots that are online: this server no longer hears them.
  void EndPresence();
  void WaitForJournals(SteadyTime deadline);
  /// Messages that are not settled, of robots' streams and of the broker.
  [[nodiscard]] std::int64_t Unsettled() const;
  /// The rest did not end in time: the process does, with what it has.
  void EndUnfinished();

  const Context context_;
};

}  // namespace uplink::run
