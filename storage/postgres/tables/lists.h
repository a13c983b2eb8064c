#pragma once

#include <optional>
#include <type_traits>

#include "storage/lists.h"
#include "storage/postgres/tables/faults.h"
#include "storage/postgres/tables/latest.h"
#include "storage/postgres/tables/mission_runs.h"
#include "storage/postgres/tables/reports.h"
#include "storage/postgres/tables/scope_updates.h"
#include "storage/postgres/tables/set_aside.h"
#include "storage/postgres/tables/spatial.h"

// Which table each list reads.
namespace uplink::storage::postgres {

/// `kTable` is the table of the list.
template <PageKind kList>
struct ListTable;
#define UPLINK_LIST(Name, number, Row, Query, retained)                                 \
  template <>                                                                           \
  struct ListTable<PageKind::k##Name> {                                                 \
    static constexpr const auto& kTable = k##Name##Table;                               \
    static_assert(std::is_same_v<std::remove_cvref_t<decltype(kTable)>::ListRow, Row>); \
  };
UPLINK_LISTS(UPLINK_LIST)
#undef UPLINK_LIST

/// What a row of the list's table is written from.
template <PageKind kList>
using InOf = typename std::remove_cvref_t<decltype(ListTable<kList>::kTable)>::In;

/// The history to which reports of a kind go as they came; nothing if there is none.
template <typename Body>
consteval std::optional<PageKind> HistoryOf() {
  std::optional<PageKind> history;
  ForEachList([&history]<PageKind kList>() {
    if constexpr (std::is_same_v<InOf<kList>, Report<Body>>) history = kList;
  });
  return history;
}

}  // namespace uplink::storage::postgres
