#include "storage/sqlite/quarantine_bound.h"

#include <algorithm>
#include <array>

#include "storage/bounds.h"
#include "storage/numbers.h"
#include "storage/sqlite/counts.h"
#include "storage/sqlite/prepare.h"

namespace uplink::storage::sqlite {

absl::Status QuarantineBound::Prepare(Database& database) {
  Preparer prepare(database);
  prepare.Into(count_, "SELECT COUNT(*) FROM quarantine WHERE ruri = ?");
  // A session that is not kept has no row, or one that begins above the quarantine row. No Hello
  // asks for what did not come by the relay.
  prepare.Into(trim_,
               "DELETE FROM quarantine WHERE rowid IN (SELECT q.rowid FROM quarantine AS q"
               " LEFT JOIN sessions AS s ON s.ruri = q.ruri AND s.session = q.session"
               " AND q.entry >= s.first_entry"
               " WHERE q.ruri = ?1 AND (s.session IS NULL OR q.seq <= s.settled_seq OR"
               " q.source <> 0)"
               " ORDER BY s.session IS NOT NULL, q.entry LIMIT ?2) RETURNING reason");
  prepare.Into(add_,
               "INSERT INTO quarantine_dropped (ruri, reason, count) VALUES (?, ?, ?)"
               " ON CONFLICT (ruri, reason) DO UPDATE SET count = count + excluded.count");
  return prepare.status();
}

absl::StatusOr<Trimmed> QuarantineBound::Trim(std::span<const std::string> ruris) {
  Trimmed trimmed;
  for (std::size_t place = 0; place < ruris.size(); ++place) {
    const absl::StatusOr<std::size_t> rows = CountOf(*count_, ruris[place]);
    if (!rows.ok()) return rows.status();
    if (*rows <= kQuarantineRowsPerRobotMax) continue;
    const std::size_t over = std::min(*rows - kQuarantineRowsPerRobotMax, kTrimRowsMax);
    const absl::StatusOr<std::size_t> went =
        TrimOne(ruris[place], static_cast<std::int64_t>(over), trimmed);
    if (!went.ok()) return went.status();
    if (*went == kTrimRowsMax) trimmed.unfinished.push_back(place);
  }
  return trimmed;
}

absl::StatusOr<std::size_t> QuarantineBound::TrimOne(std::string_view ruri, std::int64_t rows_max,
                                                     Trimmed& trimmed) {
  std::array<std::size_t, model::kRejectReasons + 1> dropped{};
  std::size_t count = 0;
  {
    Rows rows = trim_->Select(ruri, rows_max);
    while (true) {
      const absl::StatusOr<bool> found = rows.Next();
      if (!found.ok()) return found.status();
      if (!*found) break;
      ++dropped[static_cast<std::size_t>(ReasonOf(rows.Int(0)))];
      ++count;
    }
  }
  for (std::size_t reason = 0; reason < dropped.size(); ++reason) {
    if (dropped[reason] == 0) continue;
    absl::Status added = add_->Run(ruri, static_cast<std::int64_t>(reason),
                                   static_cast<std::int64_t>(dropped[reason]));
    if (!added.ok()) return added;
    trimmed.dropped[reason] += dropped[reason];
  }
  return count;
}

}  // namespace uplink::storage::sqlite
