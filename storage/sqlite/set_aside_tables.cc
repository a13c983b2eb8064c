#include <string>

#include "storage/numbers.h"
#include "storage/sqlite/counts.h"
#include "storage/sqlite/prepare.h"
#include "storage/sqlite/tables.h"

namespace uplink::storage::sqlite {
namespace {

constexpr auto kNothing = std::string_view();

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
  prepare.Into(insert_,
               "INSERT INTO quarantine (ruri, session, seq, entry, fleet, received_ms, reason,"
               " field, detail, payload_bytes, payload) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  prepare.Into(rejects_,
               "SELECT seq, reason, field, detail FROM quarantine WHERE ruri = ? AND session = ?"
               " AND seq > ? AND seq <= ? AND entry >= ? ORDER BY seq LIMIT ?");
  prepare.Into(count_payloads_,
               "SELECT COUNT(*) FROM quarantine WHERE ruri = ? AND payload IS NOT NULL");
  prepare.Into(thin_,
               "UPDATE quarantine SET payload = NULL WHERE rowid IN (SELECT rowid FROM quarantine"
               " WHERE ruri = ? AND payload IS NOT NULL ORDER BY entry LIMIT ?)");
  prepare.Into(upsert_gap_,
               "INSERT INTO gaps (ruri, session, first, last, fleet, seen_ms, entry)"
               " VALUES (?, ?, ?, ?, ?, ?, ?) ON CONFLICT (ruri, session, first)"
               " DO UPDATE SET last = max(last, excluded.last)");
  prepare.Into(count_gaps_, "SELECT COUNT(*) FROM gaps WHERE ruri = ?");
  prepare.Into(trim_gaps_,
               "DELETE FROM gaps WHERE rowid IN (SELECT rowid FROM gaps WHERE ruri = ?"
               " ORDER BY seen_ms, entry LIMIT ?)");
  return prepare.status();
}

absl::Status SetAsideTables::Insert(const CommitRecord& record, const model::Rejection& rejection,
                                    EntryNumber entry) {
  const auto run = [&](std::string_view field, std::string_view detail, const Blob& payload) {
    return insert_->Run(std::string_view(record.robot->ruri), Blob{record.session.AsBytes()},
                        record.seq, entry, std::string_view(record.robot->fleet),
                        UnixMs(record.received_at), static_cast<std::int64_t>(rejection.reason),
                        field, detail, record.payload_bytes, payload);
  };
  const Blob payload = record.payload.empty() ? Blob() : Blob{record.payload};
  absl::Status status = run(rejection.field, rejection.detail, payload);
  if (absl::IsInvalidArgument(status) && payload.bytes) {
    status = run(rejection.field, rejection.detail, Blob());
  }
  if (absl::IsInvalidArgument(status)) status = run(kNothing, kNothing, Blob());
  return status;
}

absl::StatusOr<std::vector<StoredReject>> SetAsideTables::Rejects(const RejectRange& range,
                                                                  std::size_t rejects_max) {
  std::vector<StoredReject> rejects;
  Rows rows =
      rejects_->Select(range.ruri, Blob{range.session.AsBytes()}, range.above, range.through,
                       range.first_entry, static_cast<std::int64_t>(rejects_max));
  while (true) {
    const absl::StatusOr<bool> found = rows.Next();
    if (!found.ok()) return found.status();
    if (!*found) return rejects;
    rejects.push_back(
        {static_cast<model::Seq>(rows.Int(0)),
         {ReasonOf(rows.Int(1)), std::string(rows.Bytes(2)), std::string(rows.Bytes(3))}});
  }
}

absl::Status SetAsideTables::ThinPayloads(std::string_view ruri) {
  const absl::StatusOr<std::int64_t> over =
      CountOver(*count_payloads_, ruri, kQuarantinePayloadsPerRobotMax);
  if (!over.ok() || *over == 0) return over.status();
  return thin_->Run(ruri, *over);
}

absl::Status SetAsideTables::UpsertGap(const GapItem& gap, EntryNumber entry) {
  return upsert_gap_->Run(std::string_view(gap.robot->ruri), Blob{gap.session.AsBytes()}, gap.first,
                          gap.last, std::string_view(gap.robot->fleet), UnixMs(gap.seen_at), entry);
}

absl::Status SetAsideTables::TrimGaps(std::string_view ruri) {
  const absl::StatusOr<std::int64_t> over = CountOver(*count_gaps_, ruri, kGapsPerRobotMax);
  if (!over.ok() || *over == 0) return over.status();
  return trim_gaps_->Run(ruri, *over);
}

}  // namespace uplink::storage::sqlite
