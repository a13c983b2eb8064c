#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

/// The lists that are read in pages, one row each: LIST(Name, number, Row, Query, retained).
///
///   Name      the function of storage::Reader; names it in code: PageKind::kName. It has a table,
///             kNameTable in `tables/`
///   number    part of the tokens that readers hold: it never changes
///   Row       what it is a list of (rows.h)
///   Query     what it takes (reader.h); from and to bound the time that orders it
///   retained  of Retained: how long its rows are kept
///
/// Reader, the readers of both stores, tokens, the tables that a batch fills and what goes for its
/// age are made from these rows, in this order. A new one also needs its row's struct, a table, a
/// migration of each store, and a route of the HTTP API.
#define UPLINK_LISTS(LIST)                                                          \
  /* Faults that are active now, one row per fault. */                              \
  LIST(FaultsActive, 1, FaultRow, FaultsQuery, kWhilePresent)                       \
  /* Every report of a fault. */                                                    \
  LIST(FaultHistory, 2, FaultRow, FaultsQuery, kAsHistory)                          \
  LIST(Events, 5, EventRow, EventsQuery, kAsHistory)                                \
  LIST(Messages, 6, MessageRow, MessagesQuery, kAsHistory)                          \
  LIST(ScopeUpdates, 12, ScopeUpdateRow, ScopeUpdatesQuery, kAsHistory)             \
  /* Every report of the runs that match. */                                        \
  LIST(MissionReports, 8, MissionReportRow, MissionsQuery, kAsHistory)              \
  LIST(Quarantine, 3, QuarantineRow, QuarantineQuery, kAsSetAside)                  \
  LIST(PresenceChanges, 11, PresenceRow, HistoryQuery, kAsHistory)                  \
  /* from and to bound the first arrival. */                                        \
  LIST(MissionRuns, 7, MissionRunRow, MissionsQuery, kAsHistory)                    \
  /* from and to bound the arrival that opened it. */                               \
  LIST(OperatorRequests, 13, OperatorRequestRow, OperatorRequestsQuery, kAsHistory) \
  LIST(Shapes, 9, ShapeRow, PresentQuery, kWhilePresent)                            \
  LIST(Objects, 10, ObjectRow, PresentQuery, kWhilePresent)                         \
  LIST(Gaps, 4, GapRow, HistoryQuery, kAsSetAside)                                  \
  /* from and to bound the beginning. */                                            \
  LIST(Connections, 14, ConnectionRow, ConnectionsQuery, kAsConnections)

namespace uplink::storage {

/// How long the rows of a list are kept.
enum class Retained : std::uint8_t {
  /// While they are present, whatever their age.
  kWhilePresent,
  /// StoreRules.retain_history.
  kAsHistory,
  /// StoreRules.retain_quarantine.
  kAsSetAside,
  /// StoreRules.retain_connections.
  kAsConnections,
};

/// Names a list. The numbers are part of the tokens.
enum class PageKind : std::uint8_t {
#define UPLINK_LIST(Name, number, Row, Query, retained) k##Name = (number),
  UPLINK_LISTS(UPLINK_LIST)
#undef UPLINK_LIST
  /// Reader::Audit, whose rows are no robot's and which no batch writes.
  kAudit = 15,
};

/// What the table above says of a list. A value.
struct ListEntry {
  PageKind kind;
  Retained retained;
};

#define UPLINK_LIST(Name, number, Row, Query, retained) \
  ListEntry{PageKind::k##Name, Retained::retained},
/// In the order of the table above.
inline constexpr auto kLists = std::to_array<ListEntry>({UPLINK_LISTS(UPLINK_LIST)});
#undef UPLINK_LIST

[[nodiscard]] constexpr Retained RetainedOf(PageKind list) {
  for (const ListEntry& entry : kLists) {
    if (entry.kind == list) return entry.retained;
  }
  return Retained::kWhilePresent;
}

[[nodiscard]] constexpr bool ListNumbersDiffer() {
  for (std::size_t i = 0; i < kLists.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (kLists[i].kind == kLists[j].kind) return false;
    }
    if (kLists[i].kind == PageKind::kAudit) return false;
  }
  return true;
}
static_assert(ListNumbersDiffer(), "a token names one list");

/// Calls `visit` for each list, in order, with its PageKind as template argument:
/// `ForEachList([&]<PageKind kList>() { ... });`.
template <typename Visit>
constexpr void ForEachList(const Visit& visit) {
#define UPLINK_LIST(Name, number, Row, Query, retained) \
  visit.template operator()<PageKind::k##Name>();
  UPLINK_LISTS(UPLINK_LIST)
#undef UPLINK_LIST
}

}  // namespace uplink::storage
