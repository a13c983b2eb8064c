#pragma once

#include <absl/status/status.h>

#include "storage/commit_record.h"
#include "storage/decide.h"
#include "storage/sqlite/statement.h"

namespace uplink::storage::sqlite {

struct Tables;

/// Writes the rows of good records, each kind to its tables.
///
/// Thread: confined to the thread of its database.
class KindWriter final {
 public:
  /// `next_entry` is the batch's count, from which rows take theirs.
  KindWriter(Tables& tables, EntryNumber& next_entry) : tables_(tables), next_entry_(next_entry) {}

  /// Of a record that the ruling lets pass. Errors: those of the tables; kInvalidArgument if the
  /// database refuses a row.
  [[nodiscard]] absl::Status Write(const CommitRecord& record, const Ruling& ruling);

 private:
  struct Visitor;

  Tables& tables_;
  EntryNumber& next_entry_;
};

}  // namespace uplink::storage::sqlite
