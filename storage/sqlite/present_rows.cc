#include "storage/sqlite/present_rows.h"

#include <string>

#include "storage/tables/present.h"

namespace uplink::storage::sqlite {

absl::Status PresentRows::Prepare(Database& database, PresentKind kind) {
  const PresentTable& shape = kPresentTables[static_cast<std::size_t>(kind)];
  has_source_ = !shape.source_column.empty();
  const std::string table(shape.name);
  std::string key = " WHERE ruri = ? AND " + std::string(shape.id_column) + " = ?";
  if (has_source_) key += " AND " + std::string(shape.source_column) + " = ?";
  Preparer prepare(database);
  const std::string expiry(shape.expiry_column.empty() ? "0" : shape.expiry_column);
  prepare.Into(expiry_, "SELECT " + expiry + " FROM " + table + key);
  prepare.Into(count_, "SELECT COUNT(*) FROM " + table + " WHERE ruri = ?");
  prepare.Into(delete_, "DELETE FROM " + table + key);
  if (!BoundOf(kind).expires) return prepare.status();
  prepare.Into(delete_expired_, "DELETE FROM " + table +
                                    " WHERE ruri = ? AND expires_ms != 0 AND expires_ms <= ?"
                                    " RETURNING 1");
  prepare.Into(sweep_, "DELETE FROM " + table + " WHERE rowid IN (SELECT rowid FROM " + table +
                           " WHERE expires_ms != 0 AND expires_ms <= ? ORDER BY expires_ms"
                           " LIMIT ?) RETURNING 1");
  return prepare.status();
}

Rows PresentRows::SelectKey(Statement& statement, const PresentKey& key) const {
  return has_source_ ? statement.Select(key.ruri, key.id, key.source)
                     : statement.Select(key.ruri, key.id);
}

absl::StatusOr<std::optional<std::int64_t>> PresentRows::ExpiryOf(const PresentKey& key) {
  return SelectKey(*expiry_, key).First([](const Rows& row) { return row.Int(0); });
}

absl::StatusOr<std::size_t> PresentRows::Count(std::string_view ruri) {
  const absl::StatusOr<std::int64_t> count = count_->Select(ruri).OnlyInt();
  if (!count.ok()) return count.status();
  return static_cast<std::size_t>(*count);
}

absl::Status PresentRows::Delete(const PresentKey& key) {
  return SelectKey(*delete_, key).Next().status();
}

absl::StatusOr<std::size_t> PresentRows::DeleteExpired(std::string_view ruri, std::int64_t now_ms) {
  return delete_expired_->Select(ruri, now_ms).Count();
}

absl::StatusOr<std::size_t> PresentRows::Sweep(std::int64_t until_ms, std::size_t rows_max) {
  return sweep_->Select(until_ms, rows_max).Count();
}

}  // namespace uplink::storage::sqlite
