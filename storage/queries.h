#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schema/base/clock.h"
#include "schema/model/connection.h"
#include "schema/model/message_source.h"
#include "schema/model/mission.h"
#include "schema/model/rejection.h"
#include "schema/model/reports.h"
#include "schema/model/scope_update.h"
#include "storage/fleets.h"

// What the lists are asked for (lists.h). Values.
namespace uplink::storage {

inline constexpr std::uint32_t kPageSizeDefault = 100;
inline constexpr std::uint32_t kPageSizeMax = 1'000;
/// Robots that one query names at most: each is a search of its own in an index.
inline constexpr std::size_t kRurisMax = 100;

enum class ListOrder : std::uint8_t { kNewestFirst, kOldestFirst };

/// Which rows, and which part of them. Empty texts and lists match everything.
struct HistoryQuery {
  /// At most kRurisMax; rows of any of them.
  std::vector<std::string> ruris;
  /// At most kFleetsMax; rows of any of them.
  std::vector<std::string> fleets;
  /// Without rows of no robot (origin.h).
  bool robots_alone = false;
  /// Arrival times, both inclusive.
  std::optional<SystemTime> from;
  std::optional<SystemTime> to;
  ListOrder order = ListOrder::kNewestFirst;
  /// 1 to kPageSizeMax.
  std::uint32_t page_size = kPageSizeDefault;
  /// next_token of the page before, which had the same order; empty for the first.
  std::string page_token;
};

/// Robots or fleets of a query, each once, ascending.
[[nodiscard]] inline std::vector<std::string_view> Distinct(const std::vector<std::string>& names) {
  std::vector<std::string_view> distinct(names.begin(), names.end());
  std::ranges::sort(distinct);
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  return distinct;
}

/// Which faults. Empty texts match everything.
struct FaultsQuery {
  HistoryQuery rows;
  std::optional<model::FaultSeverity> severity{};
  std::string fault_id{};
  /// The robot's own word.
  std::string source{};
};

/// Which events.
struct EventsQuery {
  HistoryQuery rows;
  /// As EventRow.kind; empty: every kind.
  std::string kind{};
};

/// Which messages.
struct MessagesQuery {
  HistoryQuery rows;
  std::optional<model::MessageLevel> level{};
};

/// Which mission runs. Empty texts match everything.
struct MissionsQuery {
  HistoryQuery rows;
  std::string mission_id{};
  std::string run_id{};
  std::optional<model::MissionStatus> status{};
  /// Only runs whose latest status is not terminal and that the server did not close; no meaning
  /// for their reports.
  bool open = false;
};

/// Which shapes or objects.
struct PresentQuery {
  HistoryQuery rows;
  /// What expired at or before this time is left out.
  SystemTime now;
  /// Also those that expired and are not yet swept.
  bool include_expired = false;
};

/// Which requests to operators.
struct OperatorRequestsQuery {
  HistoryQuery rows;
  /// Only those that wait for an operator.
  bool open = false;
};

/// Which connections.
struct ConnectionsQuery {
  HistoryQuery rows;
  /// Only those that have not ended.
  bool open = false;
  /// Nothing: whatever way they came.
  std::optional<model::MessageSource> source{};
  /// Only those that ended for this reason.
  std::optional<model::ConnectionEnd> why{};
};

/// Which rows of quarantine.
struct QuarantineQuery {
  HistoryQuery rows;
  /// Nothing: whatever way they came.
  std::optional<model::MessageSource> source{};
  /// Nothing: for whatever reason.
  std::optional<model::RejectReason> reason{};
};

/// Which rows of the audit. Empty texts match everything. Of `rows`, `ruris` are targets, and
/// `robots_alone` means nothing.
struct AuditQuery {
  HistoryQuery rows;
  std::string who{};
  std::string action{};
  std::string target{};
};

/// Which updates of what is no robot. Empty texts match everything.
struct ScopeUpdatesQuery {
  HistoryQuery rows;
  /// Nothing: of every scope.
  std::optional<model::ScopeKind> scope{};
  std::string id{};
};

// Which rows, of any query.
[[nodiscard]] inline const HistoryQuery& RowsOf(const HistoryQuery& query) { return query; }
template <typename Query>
[[nodiscard]] const HistoryQuery& RowsOf(const Query& query) {
  return query.rows;
}

}  // namespace uplink::storage
