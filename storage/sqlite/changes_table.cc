#include "storage/sqlite/changes_table.h"

#include <cstdint>

#include "storage/shared_items.h"
#include "storage/sqlite/counts.h"
#include "storage/sqlite/prepare.h"

namespace uplink::storage::sqlite {

absl::Status ChangesTable::Prepare(Database& database) {
  Preparer prepare(database);
  prepare.Into(sweep_,
               "DELETE FROM changes WHERE number <= (SELECT max(number) FROM changes) - ?1"
               " AND number < (SELECT min(number) FROM changes) + ?2 RETURNING number");
  return prepare.status();
}

absl::StatusOr<std::size_t> ChangesTable::Sweep() {
  return CountReturned(sweep_->Select(static_cast<std::int64_t>(kChangesKept),
                                      static_cast<std::int64_t>(kChangesSweptMax)));
}

}  // namespace uplink::storage::sqlite
