#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tools/uplink-fleet/compare/conservation.h"
#include "tools/uplink-fleet/compare/findings.h"
#include "tools/uplink-fleet/robot/account.h"
#include "uplink/v1/fleet.pb.h"

namespace uplink::synthetic {

/// One line of the verification table. An empty cell means that this side does not say.
struct CheckRow {
  std::string what;
  std::string fleet;
  std::string server;
  std::string store;
  bool ok = false;
  /// Why not; empty if there is nothing to say.
  std::string note;
};

/// The line of the table for one thing. Pure.
[[nodiscard]] CheckRow LineOf(Thing thing, const Findings& findings);

/// What the fleet itself summed. A value.
struct FleetTotals {
  std::uint64_t robots = 0;
  std::uint64_t numbers = 0;
  std::uint64_t sent = 0;
  std::uint64_t durable = 0;
  /// Of these, those that an Ack covered.
  std::uint64_t acked = 0;
  std::uint64_t expiring = 0;
  std::uint64_t wrongs = 0;
  /// By reason, as counters and JSON spell it.
  std::map<std::string, std::uint64_t> wrongs_by_reason;
  std::uint64_t settled_robots = 0;
  std::uint64_t ended_ok = 0;
  /// Robots that take what others share, and the changes that came to them.
  std::uint64_t receivers = 0;
  std::uint64_t forwarded_changes = 0;

  void Add(const RobotOutcome& robot);
};

/// Everything that the table is made of. A value.
struct Evidence {
  FleetTotals fleet;
  /// What comparing robot by robot found.
  Findings findings;
  std::uint64_t robots_read = 0;
  v1::ServerStatus before;
  v1::ServerStatus after;
  /// None: the page of metrics does not have them.
  std::optional<Conservation> forwards_before;
  std::optional<Conservation> forwards_after;
  /// Receivers that showed what they hold.
  std::uint64_t receivers_read = 0;
  std::uint64_t rules_broken = 0;
  std::string first_broken_rule;
  /// Streams were broken or refused on the way, so frames may have been lost and sent again.
  bool disturbed = false;
};

/// Compares what the fleet knows with what the server counts and what the store holds.
///
/// Thread: pure; any thread.
/// Source: protocol page, Conservation: after a restart of the server only rows and acks count.
[[nodiscard]] std::vector<CheckRow> Verify(const Evidence& evidence);

/// The lines that the robots know by themselves: what was acked, and how their streams went. Pure.
[[nodiscard]] std::vector<CheckRow> VerifyAcks(const Evidence& evidence);

/// True if each line of the table agrees.
[[nodiscard]] bool AllOk(const std::vector<CheckRow>& rows);

/// True if the counters began anew between the two.
[[nodiscard]] bool Restarted(const Evidence& evidence);

}  // namespace uplink::synthetic
