#include "storage/sqlite/spatial_tables.h"

#include <array>
#include <span>
#include <string>
#include <string_view>

#include "schema/json/text.h"
#include "storage/numbers.h"
#include "storage/sqlite/prepare.h"
#include "storage/sqlite/values.h"

namespace uplink::storage::sqlite {
namespace {

/// A column that a table has beside those of both.
struct OwnColumn {
  std::string_view name;
  /// Where an empty text stands for none.
  bool empty_is_null = false;
};

constexpr auto kShapeColumns = std::to_array<OwnColumn>({
    {"name"},
    {"rev"},
    {"hash"},
    {"area_type"},
    {"scope"},
    {"min_z_m"},
    {"max_z_m"},
    {"level_id"},
    {"geometry"},
});
constexpr auto kObjectColumns = std::to_array<OwnColumn>({
    {"name"},
    {"sampled_ms"},
    {"object_type"},
    {"scope"},
    {"radius_m"},
    {"location"},
    {"trajectory", true},
});

/// Parameters 1 to 6 are those of Run(); the own columns follow.
std::string UpsertSql(const std::string& table, std::span<const OwnColumn> own) {
  std::string names = "ruri, id, fleet, first_ms, entry, received_ms, expires_ms";
  std::string values = "?1, ?2, ?3, ?4, ?5, ?4, ?6";
  std::string updates =
      "fleet = excluded.fleet, received_ms = excluded.received_ms,"
      " expires_ms = excluded.expires_ms";
  int number = 6;
  for (const OwnColumn& column : own) {
    const std::string name(column.name);
    const std::string parameter = "?" + std::to_string(++number);
    names.append(", ").append(name);
    values.append(", ").append(column.empty_is_null ? "nullif(" + parameter + ", '')" : parameter);
    updates.append(", ").append(name).append(" = excluded.").append(name);
  }
  return "INSERT INTO " + table + " (" + names + ") VALUES (" + values +
         ") ON CONFLICT (ruri, id) DO UPDATE SET " + updates;
}

template <typename... Own>
absl::Status Run(Statement& upsert, const CommitRecord& record, const std::string& id,
                 std::int64_t expires_ms, EntryNumber entry, const Own&... own) {
  return upsert.Run(View(record.robot->ruri), View(id), View(record.robot->fleet),
                    UnixMs(record.received_at), entry, expires_ms, own...);
}

}  // namespace

absl::Status SpatialTables::Prepare(Database& database) {
  Preparer prepare(database);
  prepare.Into(shape_, UpsertSql("shapes", kShapeColumns));
  prepare.Into(object_, UpsertSql("objects", kObjectColumns));
  return prepare.status();
}

absl::Status SpatialTables::Upsert(const CommitRecord& record, const model::ReportedShape& shape,
                                   std::int64_t expires_ms, EntryNumber entry) {
  const std::string geometry = json::GeometryText(shape.data);
  return Run(*shape_, record, shape.identity.id, expires_ms, entry, View(shape.identity.name),
             std::int64_t{shape.identity.rev}, View(shape.identity.hash), NumberOf(shape.area_type),
             NumberOf(shape.scope), shape.min_z_m, shape.max_z_m, std::int64_t{shape.level_id},
             View(geometry));
}

absl::Status SpatialTables::Upsert(const CommitRecord& record, const model::Object& object,
                                   std::int64_t expires_ms, EntryNumber entry) {
  const std::string location = json::Text(object.location);
  const std::string trajectory = object.trajectory ? json::Text(*object.trajectory) : "";
  return Run(*object_, record, object.id, expires_ms, entry, View(object.name), object.unix_time_ms,
             NumberOf(object.object_type), NumberOf(object.scope), object.radius_m, View(location),
             View(trajectory));
}

}  // namespace uplink::storage::sqlite
