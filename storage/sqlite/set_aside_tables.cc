#include "storage/sqlite/set_aside_tables.h"

#include <string>

#include "storage/bounds.h"
#include "storage/numbers.h"
#include "storage/sqlite/counts.h"
#include "storage/sqlite/prepare.h"

namespace uplink::storage::sqlite {
namespace {

/// The rows of a count over its bound; 0 if it is within.
absl::StatusOr<std::int64_t> CountOver(Statement& count, std::string_view ruri,
                                       std::size_t rows_max) {
  const absl::StatusOr<std::size_t> counted = CountOf(count, ruri);
  if (!counted.ok()) return counted.status();
  return *counted <= rows_max ? 0 : static_cast<std::int64_t>(*counted - rows_max);
}

}  // namespace

absl::Status SetAsideTables::Prepare(Database& database) {
  Preparer prepare(database);
  prepare.Into(rejects_, kRejectsSql);
  prepare.Into(count_rejects_, kCountRejectsSql);
  // Ranges do not overlap: the first that ends at the number or above is the one that may hold it.
  prepare.Into(rejection_,
               "SELECT reason, field, detail FROM quarantine WHERE ruri = ?1 AND session = ?2"
               " AND seq = ?3 AND entry >= ?4"
               " UNION ALL SELECT reason, field, detail FROM (SELECT first, reason, field, detail"
               " FROM kept_rejects WHERE ruri = ?1 AND session = ?2 AND last >= ?3 AND entry >= ?4"
               " ORDER BY last LIMIT 1) WHERE first <= ?3 LIMIT 1");
  // A row that is there is one of an evicted session that had the same id.
  prepare.Into(keep_,
               "INSERT OR REPLACE INTO kept_rejects"
               " (ruri, session, last, first, entry, reason, field, detail)"
               " VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
  prepare.Into(forget_kept_, kForgetKeptSql);
  prepare.Into(count_payloads_,
               "SELECT COUNT(*) FROM quarantine WHERE ruri = ? AND payload IS NOT NULL");
  prepare.Into(thin_,
               "UPDATE quarantine SET payload = NULL WHERE rowid IN (SELECT rowid FROM quarantine"
               " WHERE ruri = ? AND payload IS NOT NULL ORDER BY entry LIMIT ?)");
  prepare.Into(count_gaps_, "SELECT COUNT(*) FROM gaps WHERE ruri = ?");
  prepare.Into(trim_gaps_,
               "DELETE FROM gaps WHERE rowid IN (SELECT rowid FROM gaps WHERE ruri = ?"
               " ORDER BY seen_at, entry LIMIT ?)");
  return prepare.status();
}

absl::StatusOr<std::vector<StoredReject>> ReadRejects(Rows rows) {
  std::vector<StoredReject> rejects;
  while (true) {
    const absl::StatusOr<bool> found = rows.Next();
    if (!found.ok()) return found.status();
    if (!*found) return rejects;
    rejects.push_back(
        {static_cast<model::Seq>(rows.Int(0)),
         {ReasonOf(rows.Int(1)), std::string(rows.Bytes(2)), std::string(rows.Bytes(3))}});
  }
}

absl::StatusOr<std::vector<StoredReject>> SetAsideTables::Rejects(const RejectRange& range,
                                                                  std::size_t rejects_max) {
  return ReadRejects(rejects_->Select(range.ruri, Blob{range.session.AsBytes()}, range.above,
                                      range.through, static_cast<std::int64_t>(rejects_max)));
}

absl::StatusOr<std::size_t> SetAsideTables::CountRejects(const RejectRange& range,
                                                         std::size_t rejects_max) {
  Rows rows =
      count_rejects_->Select(range.ruri, Blob{range.session.AsBytes()}, range.above, range.through,
                             range.first_entry, static_cast<std::int64_t>(rejects_max));
  const absl::StatusOr<bool> found = rows.Next();
  if (!found.ok()) return found.status();
  return static_cast<std::size_t>(rows.Int(0));
}

absl::StatusOr<std::optional<model::Rejection>> SetAsideTables::RejectionOf(
    const RejectRange& number) {
  Rows rows = rejection_->Select(number.ruri, Blob{number.session.AsBytes()}, number.through,
                                 number.first_entry);
  const absl::StatusOr<bool> found = rows.Next();
  if (!found.ok()) return found.status();
  if (!*found) return std::optional<model::Rejection>();
  return std::optional(model::Rejection{ReasonOf(rows.Int(0)), std::string(rows.Bytes(1)),
                                        std::string(rows.Bytes(2))});
}

absl::Status SetAsideTables::Keep(const CommitRecord& record, const LimitedRange& range,
                                  EntryNumber entry) {
  return keep_->Run(
      std::string_view(record.robot->ruri), Blob{record.session.AsBytes()}, record.seq, range.first,
      entry, static_cast<std::int64_t>(range.rejection.reason),
      std::string_view(range.rejection.field), std::string_view(range.rejection.detail));
}

absl::Status SetAsideTables::ForgetKept(std::string_view ruri, const model::SessionId& session,
                                        model::Seq through) {
  return forget_kept_->Run(ruri, Blob{session.AsBytes()}, through);
}

absl::Status SetAsideTables::ThinPayloads(std::string_view ruri) {
  const absl::StatusOr<std::int64_t> over =
      CountOver(*count_payloads_, ruri, kQuarantinePayloadsPerRobotMax);
  if (!over.ok() || *over == 0) return over.status();
  return thin_->Run(ruri, *over);
}

absl::Status SetAsideTables::TrimGaps(std::string_view ruri) {
  const absl::StatusOr<std::int64_t> over = CountOver(*count_gaps_, ruri, kGapsPerRobotMax);
  if (!over.ok() || *over == 0) return over.status();
  return trim_gaps_->Run(ruri, *over);
}

}  // namespace uplink::storage::sqlite
