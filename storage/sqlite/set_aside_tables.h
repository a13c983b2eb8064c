#pragma once

#include <cstddef>
#include <memory>
#include <string_view>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/model/ids.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/entry_number.h"
#include "storage/sqlite/statement.h"
#include "storage/types.h"

namespace uplink::storage::sqlite {

/// Rejects from rows of seq, reason, field and detail of the quarantine. Errors: the database's.
absl::StatusOr<std::vector<StoredReject>> ReadRejects(Rows rows);

/// Which numbers of a session to read quarantine for.
struct RejectRange {
  std::string_view ruri;
  model::SessionId session;
  EntryNumber first_entry = 0;
  /// Not included.
  model::Seq above = 0;
  /// Included.
  model::Seq through = 0;
};

/// Quarantine and gaps, what did not become a record: which numbers lie there, and their bounds.
///
/// Errors: those of errors.h. Thread: confined to the thread of its database.
class SetAsideTables final {
 public:
  [[nodiscard]] absl::Status Prepare(Database& database);

  /// The first `rejects_max` of the range, ascending.
  [[nodiscard]] absl::StatusOr<std::vector<StoredReject>> Rejects(const RejectRange& range,
                                                                  std::size_t rejects_max);
  /// How many the range has; more than `rejects_max` are not counted.
  [[nodiscard]] absl::StatusOr<std::size_t> CountRejects(const RejectRange& range,
                                                         std::size_t rejects_max);
  /// Drops the oldest payloads of the robot over kQuarantinePayloadsPerRobotMax.
  [[nodiscard]] absl::Status ThinPayloads(std::string_view ruri);
  /// Deletes the oldest gaps of the robot over kGapsPerRobotMax.
  [[nodiscard]] absl::Status TrimGaps(std::string_view ruri);

 private:
  std::unique_ptr<Statement> rejects_, count_rejects_, count_payloads_, thin_, count_gaps_,
      trim_gaps_;
};

}  // namespace uplink::storage::sqlite
