#include "storage/sqlite/live_table.h"

#include "storage/read_row.h"
#include "storage/sqlite/table_writers.h"
#include "storage/tables/live.h"

namespace uplink::storage::sqlite {
namespace {

// Only the holder's row of robots lets anything through.
constexpr SqlText kUpsert = {
    "INSERT INTO live AS t (",
    ColumnNames(kLiveTable).view(),
    ") SELECT ",
    PlacesSql(kLiveTable).view(),
    " WHERE EXISTS (SELECT 1 FROM robots WHERE ruri = ?1 AND held_since = ?2 AND owner = ?)",
    ConflictSql(kLiveTable).view(),
    " RETURNING 1"};
constexpr SqlText kRead = {"SELECT ", LiveColumns().view(), " FROM live WHERE ruri = ?"};

}  // namespace

absl::Status LiveTable::Prepare(Database& database) {
  Preparer prepare(database);
  prepare.Into(upsert_, kUpsert.view());
  return prepare.status();
}

absl::StatusOr<bool> LiveTable::Upsert(const LiveRow& row, const ProcessId& process) {
  const BoundRow<kLiveTable> bound(*upsert_, row);
  upsert_->Bind(BoundRow<kLiveTable>::kColumns + 1, process);
  return upsert_->Select().Next();
}

absl::StatusOr<Reader::LiveRows> ReadLiveOf(Database& database,
                                            std::span<const std::string> ruris) {
  auto statement = database.Prepare(kRead.view());
  if (!statement.ok()) return statement.status();
  Reader::LiveRows live;
  std::size_t bytes = 0;
  for (const std::string& ruri : ruris) {
    if (bytes >= kPageBytesMax) break;
    absl::Status read = (*statement)->Select(ruri).ForEach([&](const Rows& row) {
      live.rows.push_back(LiveIn(row));
      bytes += row.TextBytes();
    });
    if (!read.ok()) return read;
    ++live.complete;
  }
  return live;
}

}  // namespace uplink::storage::sqlite
