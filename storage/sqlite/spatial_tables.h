#pragma once

#include <cstdint>
#include <memory>

#include <absl/status/status.h>

#include "schema/model/spatial.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/entry_number.h"
#include "storage/sqlite/statement.h"
#include "storage/types.h"

namespace uplink::storage::sqlite {

/// Upserts of shapes and objects. A row that is there keeps first_ms and entry. `expires_ms` is the
/// effective one.
///
/// Errors: those of errors.h. Thread: confined to the thread of its database.
class SpatialTables final {
 public:
  [[nodiscard]] absl::Status Prepare(Database& database);
  [[nodiscard]] absl::Status Upsert(const CommitRecord& record, const model::ReportedShape& shape,
                                    std::int64_t expires_ms, EntryNumber entry);
  [[nodiscard]] absl::Status Upsert(const CommitRecord& record, const model::Object& object,
                                    std::int64_t expires_ms, EntryNumber entry);

 private:
  std::unique_ptr<Statement> shape_, object_;
};

}  // namespace uplink::storage::sqlite
