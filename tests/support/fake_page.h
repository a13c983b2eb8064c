#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include <absl/status/statusor.h>

#include "storage/origin.h"
#include "storage/page_token.h"
#include "storage/reader.h"

namespace uplink::testing {

template <typename Row>
using FakePlaced = std::pair<storage::PagePosition, const Row*>;

// The texts and payloads of a row, for storage::kPageBytesMax.
[[nodiscard]] inline std::size_t BytesOf(const storage::FaultRow& row) {
  const model::Fault& fault = row.fault;
  return fault.fault_id.size() + fault.source.size() + fault.category.size() +
         fault.description.size() + fault.suggested_action.size();
}
[[nodiscard]] inline std::size_t BytesOf(const storage::QuarantineRow& row) {
  return row.rejection.field.size() + row.rejection.detail.size() + row.payload.size() +
         row.topic.size();
}
[[nodiscard]] inline std::size_t BytesOf(const storage::GapRow& /*row*/) { return 0; }
[[nodiscard]] inline std::size_t BytesOf(const storage::EventRow& row) {
  return row.kind.size() + row.detail_json.size();
}
[[nodiscard]] inline std::size_t BytesOf(const storage::MessageRow& row) {
  return row.message.message.size() + row.message.detail_json.size() +
         row.message.source_level.size();
}
[[nodiscard]] inline std::size_t BytesOf(const storage::ScopeUpdateRow& row) {
  return row.update.id.size() + row.update.type.size() + row.update.detail_json.size();
}
[[nodiscard]] inline std::size_t BytesOf(const storage::OperatorRequestRow& row) {
  return row.request_id.size() + row.text.size();
}
[[nodiscard]] inline std::size_t BytesOf(const storage::MissionRunRow& row) {
  return row.mission_id.size() + row.run_id.size() + row.name.size() + row.latest_json.size();
}
[[nodiscard]] inline std::size_t BytesOf(const storage::MissionReportRow& row) {
  return row.mission_id.size() + row.run_id.size() + row.report_json.size();
}
[[nodiscard]] inline std::size_t BytesOf(const storage::ShapeRow& row) {
  return row.identity.id.size() + row.identity.name.size() + row.identity.hash.size() +
         row.geometry_json.size();
}
[[nodiscard]] inline std::size_t BytesOf(const storage::ObjectRow& row) {
  return row.id.size() + row.name.size() + row.location_json.size() + row.trajectory_json.size();
}
[[nodiscard]] inline std::size_t BytesOf(const storage::PresenceRow& /*row*/) { return 0; }
[[nodiscard]] inline std::size_t BytesOf(const storage::ConnectionRow& row) {
  return row.server.size() + row.address.size() + row.gateway.size() + row.agent_version.size() +
         row.certificate.serial.size() + row.certificate.sha256.size() +
         row.certificate.key_sha256.size() + row.held_back_why.size() + row.code.size() +
         row.detail.size();
}

[[nodiscard]] inline std::size_t BytesOf(const storage::AuditRow& row) {
  return row.who.size() + row.from.size() + row.action.size() + row.target.size() +
         row.fleet.size() + row.outcome.size() + row.detail.size();
}

// What `ruris` and `fleets` of a query are compared with.
template <typename Row>
[[nodiscard]] model::RobotId FakeRobotOf(const Row& row) {
  return row.robot;
}
[[nodiscard]] inline model::RobotId FakeRobotOf(const storage::AuditRow& row) {
  return {row.target, row.fleet};
}

[[nodiscard]] inline bool FakeMatches(const model::RobotId& robot, SystemTime at,
                                      const storage::HistoryQuery& query) {
  return (query.ruris.empty() || std::ranges::find(query.ruris, robot.ruri) != query.ruris.end()) &&
         storage::LooksAt(query.fleets, robot.fleet) &&
         !(query.robots_alone && storage::IsNoRobot(robot.ruri)) &&
         (!query.from || at >= *query.from) && (!query.to || at <= *query.to);
}

/// The page that `query` asks for out of all rows, in whatever order they come.
template <typename Row>
absl::StatusOr<storage::Page<Row>> FakePageOf(storage::PageKind kind,
                                              const storage::HistoryQuery& query,
                                              std::vector<FakePlaced<Row>> rows) {
  const absl::StatusOr<std::optional<storage::PagePosition>> start =
      storage::PageStart(kind, query);
  if (!start.ok()) return start.status();
  const bool newest = query.order == storage::ListOrder::kNewestFirst;
  const auto before = [newest](const storage::PagePosition& a, const storage::PagePosition& b) {
    return newest ? a > b : a < b;
  };
  std::erase_if(rows, [&](const FakePlaced<Row>& row) {
    return !FakeMatches(FakeRobotOf(*row.second), row.first.at, query) ||
           (start->has_value() && !before(**start, row.first));
  });
  std::ranges::sort(rows, before, &FakePlaced<Row>::first);
  storage::Page<Row> page;
  std::size_t bytes = 0;
  for (const auto& [place, row] : rows) {
    page.rows.push_back(*row);
    page.positions.push_back(place);
    bytes += BytesOf(*row);
    if (page.rows.size() < query.page_size && bytes < storage::kPageBytesMax) continue;
    if (page.rows.size() < rows.size()) {
      page.next_token = EncodePageToken(kind, query.order, place);
    }
    break;
  }
  return page;
}

}  // namespace uplink::testing
