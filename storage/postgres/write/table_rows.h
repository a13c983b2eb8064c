#pragma once

#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "storage/postgres/link/connection.h"
#include "storage/postgres/tables/insert.h"
#include "storage/tables/lists.h"

// What a batch writes to tables, by table. Views and pointers lead into the batch.
namespace uplink::storage::postgres {

/// What a batch adds to one table, to which rows are only added.
template <const auto& kTable>
struct TableRows {
  std::vector<typename std::remove_cvref_t<decltype(kTable)>::In> rows;
};

/// What a batch adds to the tables of lists to which rows are only added, each row as it comes. The
/// batch must outlive it.
class AddedRows final {
 public:
  template <const auto& kTable>
  void Add(typename std::remove_cvref_t<decltype(kTable)>::In row) {
    static_assert(kTable.writes == Writes::kInserts, "an upsert writes each key once per batch");
    std::get<TableRows<kTable>>(tables_).rows.push_back(std::move(row));
  }

  /// Adds a statement per table that gets any, in the order of the lists.
  void MoveInto(std::vector<StoreCall>& calls) const {
    ForEachList([this, &calls]<PageKind kList>() {
      static constexpr const auto& kTable = List<kList>::kTable;
      if constexpr (kTable.writes == Writes::kInserts) {
        AddInsert<kTable>(std::get<TableRows<kTable>>(tables_).rows, calls);
      }
    });
  }

 private:
  template <typename /*none*/, typename... Tables>
  using TupleOf = std::tuple<Tables...>;
#define UPLINK_LIST(Name, number, Row, Query, retained) , TableRows<k##Name##Table>
  TupleOf<void UPLINK_LISTS(UPLINK_LIST)> tables_;
#undef UPLINK_LIST
};

}  // namespace uplink::storage::postgres
