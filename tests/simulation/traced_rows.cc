#include "tests/simulation/traced_rows.h"

#include <string>

#include <absl/strings/escaping.h>
#include <fmt/format.h>

#include "tests/simulation/rows.h"

namespace uplink::simulation {
namespace {

/// More robots than a simulated world has.
constexpr std::uint32_t kRobotsMax = 100;

std::string TextOf(const storage::RobotRow& row) {
  return fmt::format("robot {} fleet {} first {} last {} presence {}", row.robot.ruri,
                     row.robot.fleet, UnixMs(row.first_seen), UnixMs(row.last_seen),
                     row.last_presence ? model::ToText(*row.last_presence) : "none");
}

std::string TextOf(const storage::FaultRow& row) {
  const model::Fault& fault = row.fault;
  return fmt::format(
      "{} id {} source {} severity {} active {} {} {} {} sampled {} received {} "
      "raised {}",
      row.robot.ruri, fault.fault_id, fault.source, static_cast<int>(fault.severity), fault.active,
      fault.category, fault.description, fault.suggested_action, fault.unix_time_ms,
      UnixMs(row.received_at), row.raised_at ? UnixMs(*row.raised_at) : 0);
}

std::string TextOf(const storage::EventRow& row) {
  return fmt::format("{} {} {} sampled {} received {}", row.robot.ruri, row.kind, row.detail_json,
                     row.sampled_at_ms, UnixMs(row.received_at));
}

std::string TextOf(const storage::QuarantineRow& row) {
  return fmt::format("{} session {} seq {} {} \"{}\" \"{}\" received {} payload {} of {} bytes",
                     row.robot.ruri, row.session.ToHex(), row.seq,
                     model::ToText(row.rejection.reason), row.rejection.field, row.rejection.detail,
                     UnixMs(row.received_at), absl::BytesToHexString(row.payload),
                     row.payload_bytes);
}

std::string TextOf(const storage::GapRow& row) {
  return fmt::format("{} session {} from {} to {} seen {}", row.robot.ruri, row.session.ToHex(),
                     row.first, row.last, UnixMs(row.seen_at));
}

std::string TextOf(const storage::PresenceRow& row) {
  return fmt::format("{} {} at {}", row.robot.ruri, model::ToText(row.presence), UnixMs(row.at));
}

template <typename Row, typename Read>
void TraceTable(const char* name, Trace& trace, const Read& read) {
  // An empty RURI stands for all robots.
  for (const Row& row : AllRows<Row>("", read)) {
    trace.Add(fmt::format("row of {}: {}", name, TextOf(row)));
  }
}

}  // namespace

void TraceRows(storage::Reader& reader, Trace& trace) {
  using Query = storage::HistoryQuery;
  const auto robots = reader.Robots(kRobotsMax);
  UPLINK_CHECK(robots.ok(), robots.status().ToString());
  for (const storage::RobotRow& row : *robots) trace.Add("row of robots: " + TextOf(row));
  TraceTable<storage::FaultRow>("active faults", trace, [&](const Query& query) {
    return reader.FaultsActive({.rows = query});
  });
  TraceTable<storage::FaultRow>("fault reports", trace, [&](const Query& query) {
    return reader.FaultHistory({.rows = query});
  });
  TraceTable<storage::EventRow>("events", trace,
                                [&](const Query& query) { return reader.Events({.rows = query}); });
  TraceTable<storage::QuarantineRow>(
      "quarantine", trace, [&](const Query& query) { return reader.Quarantine({.rows = query}); });
  TraceTable<storage::GapRow>("gaps", trace,
                              [&](const Query& query) { return reader.Gaps(query); });
  TraceTable<storage::PresenceRow>(
      "presence", trace, [&](const Query& query) { return reader.PresenceChanges(query); });
}

}  // namespace uplink::simulation
