#include <string>

#include "schema/base/check.h"
#include "schema/json/text.h"
#include "storage/numbers.h"
#include "storage/sqlite/kind_tables.h"
#include "storage/sqlite/prepare.h"
#include "storage/sqlite/values.h"

namespace uplink::storage::sqlite {
namespace {

/// How many rows a deletion that returns each of them deleted.
absl::StatusOr<std::size_t> CountRows(Rows rows) {
  std::size_t count = 0;
  while (true) {
    const absl::StatusOr<bool> found = rows.Next();
    if (!found.ok()) return found.status();
    if (!*found) return count;
    ++count;
  }
}

}  // namespace

absl::Status PresentRows::Prepare(Database& database, const std::string& table) {
  Preparer prepare(database);
  prepare.Into(expiry_, "SELECT expires_ms FROM " + table + " WHERE ruri = ? AND id = ?");
  prepare.Into(count_, "SELECT COUNT(*) FROM " + table + " WHERE ruri = ?");
  prepare.Into(delete_, "DELETE FROM " + table + " WHERE ruri = ? AND id = ?");
  prepare.Into(delete_expired_, "DELETE FROM " + table +
                                    " WHERE ruri = ? AND expires_ms != 0 AND expires_ms <= ?"
                                    " RETURNING 1");
  prepare.Into(sweep_, "DELETE FROM " + table + " WHERE rowid IN (SELECT rowid FROM " + table +
                           " WHERE expires_ms != 0 AND expires_ms <= ? ORDER BY expires_ms"
                           " LIMIT ?) RETURNING 1");
  return prepare.status();
}

absl::StatusOr<std::optional<std::int64_t>> PresentRows::ExpiryOf(std::string_view ruri,
                                                                  std::string_view id) {
  Rows rows = expiry_->Select(ruri, id);
  const absl::StatusOr<bool> found = rows.Next();
  if (!found.ok()) return found.status();
  if (!*found) return std::optional<std::int64_t>();
  return std::optional<std::int64_t>(rows.Int(0));
}

absl::StatusOr<std::size_t> PresentRows::Count(std::string_view ruri) {
  Rows rows = count_->Select(ruri);
  const absl::StatusOr<bool> found = rows.Next();
  if (!found.ok()) return found.status();
  UPLINK_CHECK(*found, "a count is a row");
  return static_cast<std::size_t>(rows.Int(0));
}

absl::Status PresentRows::Delete(std::string_view ruri, std::string_view id) {
  return delete_->Run(ruri, id);
}

absl::StatusOr<std::size_t> PresentRows::DeleteExpired(std::string_view ruri, std::int64_t now_ms) {
  return CountRows(delete_expired_->Select(ruri, now_ms));
}

absl::StatusOr<std::size_t> PresentRows::Sweep(std::int64_t until_ms, std::size_t rows_max) {
  return CountRows(sweep_->Select(until_ms, static_cast<std::int64_t>(rows_max)));
}

absl::Status ShapeTable::Prepare(Database& database) {
  absl::Status status = rows_.Prepare(database, "shapes");
  if (!status.ok()) return status;
  Preparer prepare(database);
  prepare.Into(
      upsert_,
      "INSERT INTO shapes (ruri, id, fleet, first_ms, entry, received_ms, expires_ms, name,"
      " rev, hash, area_type, scope, min_z_m, max_z_m, level_id, geometry)"
      " VALUES (?1, ?2, ?3, ?4, ?5, ?4, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15)"
      " ON CONFLICT (ruri, id) DO UPDATE SET fleet = excluded.fleet,"
      " received_ms = excluded.received_ms, expires_ms = excluded.expires_ms,"
      " name = excluded.name, rev = excluded.rev, hash = excluded.hash,"
      " area_type = excluded.area_type, scope = excluded.scope,"
      " min_z_m = excluded.min_z_m, max_z_m = excluded.max_z_m,"
      " level_id = excluded.level_id, geometry = excluded.geometry");
  return prepare.status();
}

absl::Status ShapeTable::Upsert(const CommitRecord& record, const model::ReportedShape& shape,
                                EntryNumber entry) {
  const std::string geometry = json::GeometryText(shape.data);
  return upsert_->Run(View(record.robot->ruri), View(shape.identity.id), View(record.robot->fleet),
                      UnixMs(record.received_at), entry, shape.expire_time_ms,
                      View(shape.identity.name), std::int64_t{shape.identity.rev},
                      View(shape.identity.hash), NumberOf(shape.area_type), NumberOf(shape.scope),
                      shape.min_z_m, shape.max_z_m, std::int64_t{shape.level_id}, View(geometry));
}

absl::Status ObjectTable::Prepare(Database& database) {
  absl::Status status = rows_.Prepare(database, "objects");
  if (!status.ok()) return status;
  Preparer prepare(database);
  prepare.Into(upsert_,
               "INSERT INTO objects (ruri, id, fleet, first_ms, entry, received_ms, expires_ms,"
               " name, sampled_ms, object_type, scope, radius_m, location, trajectory)"
               " VALUES (?1, ?2, ?3, ?4, ?5, ?4, ?6, ?7, ?8, ?9, ?10, ?11, ?12,"
               " nullif(?13, ''))"
               " ON CONFLICT (ruri, id) DO UPDATE SET fleet = excluded.fleet,"
               " received_ms = excluded.received_ms, expires_ms = excluded.expires_ms,"
               " name = excluded.name, sampled_ms = excluded.sampled_ms,"
               " object_type = excluded.object_type, scope = excluded.scope,"
               " radius_m = excluded.radius_m, location = excluded.location,"
               " trajectory = excluded.trajectory");
  return prepare.status();
}

absl::Status ObjectTable::Upsert(const CommitRecord& record, const model::Object& object,
                                 std::int64_t expires_ms, EntryNumber entry) {
  const std::string location = json::Text(object.location);
  const std::string trajectory = object.trajectory ? json::Text(*object.trajectory) : "";
  return upsert_->Run(View(record.robot->ruri), View(object.id), View(record.robot->fleet),
                      UnixMs(record.received_at), entry, expires_ms, View(object.name),
                      object.unix_time_ms, NumberOf(object.object_type), NumberOf(object.scope),
                      object.radius_m, View(location), View(trajectory));
}

}  // namespace uplink::storage::sqlite
