#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tools/uplink-fleet/compare/verify_drones.h"
#include "tools/uplink-fleet/compare/verify_twins.h"
#include "tools/uplink-fleet/report/process_use.h"
#include "tools/uplink-fleet/robot/account.h"
#include "tools/uplink-fleet/robot/histogram.h"
#include "tools/uplink-fleet/robot/shared.h"

namespace uplink::synthetic {

/// What a run did, beside the table. A value.
struct RunFigures {
  std::uint64_t robots = 0;
  std::uint64_t seed = 0;
  std::string run;
  double seconds = 0;
  std::uint64_t sent = 0;
  /// Of these, what left before the robots began to settle: what server and own CPU stand for.
  std::uint64_t sent_while_measured = 0;
  std::uint64_t resent = 0;
  /// Messages that the server judged and said so to the robots.
  std::uint64_t judged = 0;
  /// Good durable messages that Acks covered; wrong ones count in `rejects` alone.
  std::uint64_t acked_durable = 0;
  std::uint64_t rejects = 0;
  /// Rejects that robots were told, by reason as JSON spells it.
  std::map<std::string, std::uint64_t> rejects_by_reason;
  std::uint64_t notices = 0;
  /// Robots that receive what others share; the changes that came to all of them together, and
  /// the snapshots.
  std::uint64_t receivers = 0;
  std::uint64_t forwarded_changes = 0;
  std::uint64_t forwarded_snapshots = 0;
  std::uint64_t welcomes = 0;
  std::uint64_t breaks = 0;
  std::uint64_t takeovers = 0;
  std::uint64_t connects = 0;
  std::uint64_t skipped_ticks = 0;
  /// Robots that remember, or have waiting, as much as they may, and only moved from then on.
  std::uint64_t only_moving = 0;
  std::uint64_t drains = 0;
  bool restarted = false;
  /// Streams that ended on their own, by gRPC status name.
  std::map<std::string, std::uint64_t> ends;
  Latencies latencies;
  /// What the server's process used while the robots ran; none if it runs elsewhere.
  std::optional<ProcessUse> server;
  /// What this program itself used.
  ProcessUse own;
  /// First trouble that was overcome by reconnecting; empty if none.
  std::string first_error;
};

/// What a run with twins did, beside the table. A value.
struct TwinFigures {
  std::uint64_t seed = 0;
  std::string run;
  /// For which messages were sent.
  double seconds = 0;
  TwinTotals totals;
  std::uint64_t connections = 0;
  /// Connections that ended on their own.
  std::uint64_t breaks = 0;
  /// Messages that were left out because broker or machine were too slow.
  std::uint64_t skipped = 0;
  bool restarted = false;
  /// From a ping to its pong, through the broker.
  Histogram pong;
  /// What the server's process used meanwhile; none if it runs elsewhere.
  std::optional<ProcessUse> server;
  ProcessUse own;
  /// First trouble that was overcome by reconnecting; empty if none.
  std::string first_error;
};

/// What a run with drones did, beside the table. A value.
struct DroneFigures {
  std::uint64_t seed = 0;
  std::string run;
  /// For which calls were made.
  double seconds = 0;
  DroneTotals totals;
  /// Of the calls: those that were the second time or later, those whose answer was not taken on
  /// purpose, and links that were cut.
  std::uint64_t again = 0;
  std::uint64_t lost = 0;
  std::uint64_t cut = 0;
  bool restarted = false;
  /// From when a call was due to its answer.
  Latencies latencies;
  /// What the server's process used meanwhile; none if it runs elsewhere.
  std::optional<ProcessUse> server;
  ProcessUse own;
  /// First trouble that was overcome by calling again; empty if none.
  std::string first_error;
};

/// What the robots counted, each for itself and all together; the rest is not set.
[[nodiscard]] RunFigures SumUp(const std::vector<RobotOutcome>& robots, const Shared& shared);

/// Streams were broken or refused on the way, so that frames may have been lost and sent again.
[[nodiscard]] bool WasDisturbed(const RunFigures& figures);

/// The shares of all messages for which both reports say how long they took.
inline constexpr std::array<std::pair<const char*, double>, 4> kQuantiles = {
    {{"p50", 0.5}, {"p90", 0.9}, {"p99", 0.99}, {"p99.9", 0.999}}};

[[nodiscard]] inline double MillisOf(Histogram::Micros micros) {
  return static_cast<double>(micros.count()) / 1000;
}

}  // namespace uplink::synthetic
