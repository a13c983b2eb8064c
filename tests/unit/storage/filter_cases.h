#pragma once

#include <array>
#include <memory>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "storage/tables/lists.h"

// The filters of the lists over the whole fleet, for both stores.
namespace uplink::storage {

/// One filter of one list, and what finds its rows where no robot is named. A value.
struct FilterCase {
  std::string_view name;
  ListShape shape;
  /// Holds the texts of the filters.
  std::shared_ptr<const void> queries;
  ListFilter filter;
  /// The filter where robots are named.
  ListFilter of_robots;
  /// The columns by which the index is searched, or for those of part of a table, its name.
  std::string_view index;
};

inline void PrintTo(const FilterCase& one, std::ostream* out) { *out << one.name; }

template <PageKind kList, typename Query>
FilterCase CaseOf(std::string_view name, const Query& query, std::string_view index) {
  constexpr std::string_view kOpen = List<kList>::kTable.listed.open_column;
  auto queries = std::make_shared<std::array<Query, 2>>(std::array<Query, 2>{query, query});
  (*queries)[1].rows.ruris = {"r"};
  FilterCase one{name,
                 List<kList>::kShape,
                 queries,
                 FilterOf((*queries)[0], kOpen),
                 FilterOf((*queries)[1], kOpen),
                 index};
  return one;
}

/// Without those that most rows pass, which are found by their time: messages of level info,
/// quarantine of the relay.
inline std::vector<FilterCase> FilterCases() {
  using enum PageKind;
  const FaultsQuery severe{.rows = {}, .severity = model::FaultSeverity::kCritical};
  const FaultsQuery fault{.rows = {}, .fault_id = "f"};
  const FaultsQuery source{.rows = {}, .source = "s"};
  return {
      CaseOf<kEvents>("EventsByKind", EventsQuery{.rows = {}, .kind = "k"}, "kind"),
      CaseOf<kMessages>("MessagesByLevel",
                        MessagesQuery{.rows = {}, .level = model::MessageLevel::kError}, "level"),
      CaseOf<kFaultHistory>("FaultsBySeverity", severe, "severity"),
      CaseOf<kFaultHistory>("FaultsById", fault, "fault_id"),
      CaseOf<kFaultHistory>("FaultsBySource", source, "source"),
      CaseOf<kFaultsActive>("ActiveFaultsBySeverity", severe, "severity"),
      CaseOf<kFaultsActive>("ActiveFaultsById", fault, "fault_id"),
      CaseOf<kFaultsActive>("ActiveFaultsBySource", source, "source"),
      CaseOf<kMissionRuns>("RunsByMission", MissionsQuery{.rows = {}, .mission_id = "m"},
                           "mission_id"),
      CaseOf<kMissionRuns>("RunsByStatus",
                           MissionsQuery{.rows = {}, .status = model::MissionStatus::kError},
                           "status"),
      CaseOf<kMissionReports>("ReportsByMission", MissionsQuery{.rows = {}, .mission_id = "m"},
                              "mission_id"),
      CaseOf<kMissionReports>("ReportsByStatus",
                              MissionsQuery{.rows = {}, .status = model::MissionStatus::kError},
                              "status"),
      CaseOf<kQuarantine>("QuarantineByReason",
                          QuarantineQuery{.rows = {}, .reason = model::RejectReason::kMalformed},
                          "reason"),
      CaseOf<kQuarantine>("QuarantineBySource",
                          QuarantineQuery{.rows = {}, .source = model::MessageSource::kCyberwave},
                          "source"),
      CaseOf<kConnections>("ConnectionsByEnd",
                           ConnectionsQuery{.rows = {}, .why = model::ConnectionEnd::kSilent},
                           "ended_why"),
      CaseOf<kConnections>("ConnectionsBySource",
                           ConnectionsQuery{.rows = {}, .source = model::MessageSource::kUncrew},
                           "source"),
      CaseOf<kAudit>("AuditByWho", AuditQuery{.rows = {}, .who = "w"}, "who"),
      CaseOf<kAudit>("AuditByAction", AuditQuery{.rows = {}, .action = "a"}, "action"),
      CaseOf<kAudit>("AuditByTarget", AuditQuery{.rows = {}, .target = "t"}, "target"),
      CaseOf<kScopeUpdates>("UpdatesByScope",
                            ScopeUpdatesQuery{.rows = {}, .scope = model::ScopeKind::kEnvironment},
                            "scope"),
  };
}

/// Each way to restrict a list to robots, without a fleet, with one, and with several as a caller
/// of few fleets does, in both orders, on the first page and on a later one.
inline std::vector<HistoryQuery> RobotQueries() {
  std::vector<HistoryQuery> queries;
  using Names = std::vector<std::string>;
  for (const Names& ruris : {Names{}, Names{"r"}, Names{"r", "s", "t"}}) {
    for (const Names& fleets : {Names{}, Names{"f"}, Names{"f", "g", "h"}}) {
      // One bit each for the page and the order.
      for (unsigned bits = 0; bits < 4; ++bits) {
        HistoryQuery& query = queries.emplace_back();
        query.ruris = ruris;
        query.fleets = fleets;
        query.robots_alone = fleets.size() > 1;
        query.page_token = (bits & 1U) != 0 ? "x" : "";
        query.order = (bits & 2U) != 0 ? ListOrder::kOldestFirst : ListOrder::kNewestFirst;
      }
    }
  }
  return queries;
}

}  // namespace uplink::storage
