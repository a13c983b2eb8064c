#include "storage/sqlite/set_aside_tables.h"

#include <algorithm>
#include <array>
#include <string>

#include "storage/bounds.h"
#include "storage/read_row.h"

namespace uplink::storage::sqlite {
namespace {

/// The rows of a count over its bound; 0 if it is within.
absl::StatusOr<std::int64_t> CountOver(Statement& count, std::string_view ruri,
                                       std::size_t rows_max) {
  const absl::StatusOr<std::int64_t> counted = count.Select(ruri).OnlyInt();
  if (!counted.ok()) return counted.status();
  return std::max<std::int64_t>(*counted - static_cast<std::int64_t>(rows_max), 0);
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
  prepare.Into(count_rows_, "SELECT COUNT(*) FROM quarantine WHERE ruri = ?");
  // A session that is not kept has no row, or one that begins above the quarantine row. No Hello
  // asks for what did not come by the relay.
  prepare.Into(trim_rows_,
               "DELETE FROM quarantine WHERE rowid IN (SELECT q.rowid FROM quarantine AS q"
               " LEFT JOIN sessions AS s ON s.ruri = q.ruri AND s.session = q.session"
               " AND q.entry >= s.first_entry"
               " WHERE q.ruri = ?1 AND (s.session IS NULL OR q.seq <= s.settled_seq OR"
               " q.source <> 0)"
               " ORDER BY s.session IS NOT NULL, q.entry LIMIT ?2) RETURNING reason");
  prepare.Into(add_dropped_,
               "INSERT INTO quarantine_dropped (ruri, reason, count) VALUES (?, ?, ?)"
               " ON CONFLICT (ruri, reason) DO UPDATE SET count = count + excluded.count");
  return prepare.status();
}

absl::StatusOr<std::vector<StoredReject>> SetAsideTables::Rejects(const RejectRange& range,
                                                                  std::size_t rejects_max) {
  return rejects_->Select(range.ruri, range.session, range.above, range.through, rejects_max)
      .All([](const Rows& row) { return RejectIn(row); });
}

absl::StatusOr<std::size_t> SetAsideTables::CountRejects(const RejectRange& range,
                                                         std::size_t rejects_max) {
  const absl::StatusOr<std::int64_t> count =
      count_rejects_
          ->Select(range.ruri, range.session, range.above, range.through, range.first_entry,
                   rejects_max)
          .OnlyInt();
  if (!count.ok()) return count.status();
  return static_cast<std::size_t>(*count);
}

absl::StatusOr<std::optional<model::Rejection>> SetAsideTables::RejectionOf(
    const RejectRange& number) {
  return rejection_->Select(number.ruri, number.session, number.through, number.first_entry)
      .First([](const Rows& row) { return RejectionIn(row, 0); });
}

absl::Status SetAsideTables::ForgetKept(std::string_view ruri, const model::SessionId& session,
                                        model::Seq through) {
  return forget_kept_->Run(ruri, session, through);
}

absl::Status SetAsideTables::ThinPayloads(std::string_view ruri) {
  const auto over = CountOver(*count_payloads_, ruri, kQuarantinePayloadsPerRobotMax);
  if (!over.ok() || *over == 0) return over.status();
  return thin_->Run(ruri, *over);
}

absl::Status SetAsideTables::TrimGaps(std::string_view ruri) {
  const absl::StatusOr<std::int64_t> over = CountOver(*count_gaps_, ruri, kGapsPerRobotMax);
  if (!over.ok() || *over == 0) return over.status();
  return trim_gaps_->Run(ruri, *over);
}

absl::StatusOr<Trimmed> SetAsideTables::TrimQuarantine(std::span<const std::string> ruris) {
  Trimmed trimmed;
  for (std::size_t place = 0; place < ruris.size(); ++place) {
    const auto over = CountOver(*count_rows_, ruris[place], kQuarantineRowsPerRobotMax);
    if (!over.ok()) return over.status();
    if (*over == 0) continue;
    const auto went = TrimOne(ruris[place], std::min(*over, std::int64_t{kTrimRowsMax}), trimmed);
    if (!went.ok()) return went.status();
    if (*went == kTrimRowsMax) trimmed.unfinished.push_back(place);
  }
  return trimmed;
}

absl::StatusOr<std::size_t> SetAsideTables::TrimOne(std::string_view ruri, std::int64_t rows_max,
                                                    Trimmed& trimmed) {
  std::array<std::uint64_t, model::kRejectReasons + 1> dropped{};
  std::size_t count = 0;
  absl::Status status = trim_rows_->Select(ruri, rows_max).ForEach([&](const Rows& row) {
    ++dropped[static_cast<std::size_t>(ReasonOf(row.Int(0)))];
    ++count;
  });
  for (std::size_t reason = 0; reason < dropped.size(); ++reason) {
    if (!status.ok()) return status;
    if (dropped[reason] == 0) continue;
    status = add_dropped_->Run(ruri, reason, dropped[reason]);
    trimmed.dropped[reason] += dropped[reason];
  }
  if (!status.ok()) return status;
  return count;
}

}  // namespace uplink::storage::sqlite
