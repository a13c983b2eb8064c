#pragma once

#include <vector>

#include "storage/commit_record.h"
#include "storage/postgres/link/connection.h"

namespace uplink::storage::postgres {

/// The ranges of limited numbers that a batch keeps for their robots. The batch must outlive it.
class LimitedRows final {
 public:
  void Add(const CommitRecord& record, const LimitedRange& range, std::int32_t place) {
    rows_.push_back({&record, &range, place});
  }
  /// Adds a statement, if there is any row.
  void MoveInto(std::vector<StoreCall>& calls) const;

 private:
  struct Row {
    const CommitRecord* record = nullptr;
    const LimitedRange* range = nullptr;
    std::int32_t place = 0;
  };
  std::vector<Row> rows_;
};

}  // namespace uplink::storage::postgres
