#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/model/ids.h"
#include "storage/commit_record.h"
#include "storage/rejects.h"
#include "storage/retention.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/statement.h"

namespace uplink::storage::sqlite {

/// Rejects of a session that has a row: those in quarantine and the kept ones. Parameters: RURI,
/// session, the number above which and the one up to which, how many at most.
inline constexpr std::string_view kRejectsSql =
    "WITH RECURSIVE s (first_entry) AS (SELECT first_entry FROM sessions WHERE ruri = ?1"
    " AND session = ?2),"
    " n (seq, last, reason, field, detail) AS ("
    "SELECT * FROM (SELECT max(first, ?3 + 1), min(last, ?4), reason, field, detail"
    " FROM kept_rejects WHERE ruri = ?1 AND session = ?2 AND last > ?3 AND first <= ?4"
    " AND entry >= (SELECT first_entry FROM s) ORDER BY kept_rejects.last LIMIT ?5)"
    " UNION ALL SELECT seq + 1, last, reason, field, detail FROM n WHERE seq < last"
    " ORDER BY 1 LIMIT ?5)"
    " SELECT * FROM (SELECT seq, reason, field, detail FROM quarantine WHERE ruri = ?1"
    " AND session = ?2 AND seq > ?3 AND seq <= ?4 AND entry >= (SELECT first_entry FROM s)"
    " ORDER BY seq LIMIT ?5)"
    " UNION ALL SELECT seq, reason, field, detail FROM n ORDER BY 1 LIMIT ?5";

/// How many there are, up to the last parameter; at most as many rows are read of each table.
/// Parameters: RURI, session, the number above which and the one up to which, the session's first
/// entry, how many at most.
inline constexpr std::string_view kCountRejectsSql =
    "SELECT min(?6, (SELECT COUNT(*) FROM (SELECT 1 FROM quarantine WHERE ruri = ?1"
    " AND session = ?2 AND seq > ?3 AND seq <= ?4 AND entry >= ?5 LIMIT ?6))"
    " + (SELECT coalesce(sum(numbers), 0) FROM (SELECT min(last, ?4) - max(first, ?3 + 1) + 1"
    " AS numbers FROM kept_rejects WHERE ruri = ?1 AND session = ?2 AND last > ?3 AND first <= ?4"
    " AND entry >= ?5 ORDER BY last LIMIT ?6)))";

/// Deletes a session's kept Rejects by their key. Parameters: RURI, session, the number up to
/// which.
inline constexpr std::string_view kForgetKeptSql =
    "DELETE FROM kept_rejects WHERE ruri = ?1 AND session = ?2 AND last <= ?3";

/// Which numbers of a session to read Rejects for.
struct RejectRange {
  std::string_view ruri;
  model::SessionId session;
  EntryNumber first_entry = 0;
  /// Not included.
  model::Seq above = 0;
  /// Included.
  model::Seq through = 0;
};

/// Quarantine, kept Rejects and gaps, what did not become a record: which numbers lie there, and
/// their bounds.
///
/// Errors: those of errors.h. Thread: confined to the thread of its database.
class SetAsideTables final {
 public:
  [[nodiscard]] absl::Status Prepare(Database& database);

  /// The first `rejects_max` of the range, ascending, of a session that has a row.
  [[nodiscard]] absl::StatusOr<std::vector<StoredReject>> Rejects(const RejectRange& range,
                                                                  std::size_t rejects_max);
  /// How many the range has; more than `rejects_max` are not counted.
  [[nodiscard]] absl::StatusOr<std::size_t> CountRejects(const RejectRange& range,
                                                         std::size_t rejects_max);
  /// Why the range's last number was rejected; nothing if it was not.
  [[nodiscard]] absl::StatusOr<std::optional<model::Rejection>> RejectionOf(
      const RejectRange& number);
  /// Deletes the session's kept Rejects up to a number: those that a Hello confirmed; up to
  /// model::kSeqMax of a session that goes or is new.
  [[nodiscard]] absl::Status ForgetKept(std::string_view ruri, const model::SessionId& session,
                                        model::Seq through);
  /// Drops the oldest payloads of the robot over kQuarantinePayloadsPerRobotMax.
  [[nodiscard]] absl::Status ThinPayloads(std::string_view ruri);
  /// Deletes the oldest gaps of the robot over kGapsPerRobotMax.
  [[nodiscard]] absl::Status TrimGaps(std::string_view ruri);
  /// As Store::TrimQuarantine, within a transaction.
  [[nodiscard]] absl::StatusOr<Trimmed> TrimQuarantine(std::span<const std::string> ruris);

 private:
  /// Deletes up to `rows_max` rows that may go, and counts what went; returns how many.
  absl::StatusOr<std::size_t> TrimOne(std::string_view ruri, std::int64_t rows_max,
                                      Trimmed& trimmed);

  std::unique_ptr<Statement> rejects_, count_rejects_, count_payloads_, thin_, count_gaps_,
      trim_gaps_, rejection_, forget_kept_, count_rows_, trim_rows_, add_dropped_;
};

}  // namespace uplink::storage::sqlite
