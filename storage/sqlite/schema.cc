#include "storage/sqlite/schema.h"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "storage/sqlite/damage.h"

namespace uplink::storage::sqlite {
namespace {

/// Pages that the writer's cache may hold, in KiB: the inner pages of a large store's indexes.
constexpr int kCacheKib = 16 * 1024;

/// What SQLite keeps of the WAL's file once its content was moved and written over, in bytes: a
/// commit after a checkpoint writes less (kMovedAtFrames, and a batch), so only a WAL that grew
/// while a reader kept it is cut.
constexpr std::int64_t kWalKeptBytes = std::int64_t{16} << 20;

/// What `synchronous` is set to, and how it is shown. FULL: with less, a WAL may lose the last
/// commits at a loss of power. The crash campaign builds a program with less, to see that it finds
/// the loss.
struct Synchronous {
  const char* value;
  const char* shown;
};
#ifdef UPLINK_SYNCHRONOUS_OFF
constexpr Synchronous kSynchronous = {"OFF", "0"};
#else
constexpr Synchronous kSynchronous = {"FULL", "2"};
#endif

absl::Status Precondition(const Database& database, const std::string& text) {
  return absl::FailedPreconditionError("store " + database.path() + " " + text);
}

absl::Status Pragma(Database& database, const std::string& name, const std::string& value,
                    const std::string& shown) {
  absl::Status set = database.Execute("PRAGMA " + name + " = " + value);
  if (!set.ok()) return set;
  const absl::StatusOr<std::string> now = database.ReadText("PRAGMA " + name);
  if (!now.ok()) return now.status();
  if (*now == shown) return absl::OkStatus();
  return Precondition(database, "does not take " + name + " = " + value + ": it stays " + *now);
}

absl::StatusOr<std::vector<AppliedStep>> ReadApplied(Database& database) {
  const absl::StatusOr<std::int64_t> columns = database.ReadInt(
      "SELECT count(*) FILTER (WHERE name IN ('version', 'sha256')) * 2"
      " + count(*) FILTER (WHERE name = 'oldest') FROM pragma_table_info('schema_migrations')");
  if (!columns.ok()) return columns.status();
  std::vector<AppliedStep> applied;
  if (*columns < 4) return applied;
  // An earlier build's table has no column `oldest`.
  const std::string oldest = *columns % 2 == 0 ? "0" : "oldest";
  auto statement = database.Prepare("SELECT version, " + oldest +
                                    ", sha256 FROM schema_migrations ORDER BY version");
  if (!statement.ok()) return statement.status();
  Rows rows = (*statement)->Select();
  while (true) {
    const absl::StatusOr<bool> found = rows.Next();
    if (!found.ok()) return found.status();
    if (!*found) return applied;
    applied.push_back({rows.Int(0), rows.Int(1), std::string(rows.Bytes(2))});
  }
}

/// The steps that the file lacks.
absl::StatusOr<std::span<const Migration>> Missing(Database& database,
                                                   std::span<const Migration> migrations) {
  const auto applied = ReadApplied(database);
  if (!applied.ok()) return applied.status();
  return CheckApplied("store " + database.path(), *applied, migrations);
}

absl::Status Apply(Database& database, const Migration& migration) {
  std::string sql = "BEGIN IMMEDIATE;\n";
  sql += migration.sql;
  sql += "\nINSERT INTO schema_migrations (version, oldest, name, sha256) VALUES (" +
         std::to_string(migration.version) + ", " + std::to_string(migration.oldest) + ", '" +
         migration.name + "', '" + migration.sha256 +
         "');\nPRAGMA application_id = " + std::to_string(kApplicationId) +
         ";\nPRAGMA user_version = " + std::to_string(migration.version) + ";\nCOMMIT;";
  absl::Status applied = database.Execute(sql);
  if (applied.ok()) return applied;
  database.RollbackIfOpen();
  std::string text = "migration ";
  text += migration.name;
  text += ": ";
  text += std::string_view(applied.message().data(), applied.message().size());
  return {applied.code(), text};
}

}  // namespace

absl::Status CheckFile(Database& database, std::span<const Migration> migrations) {
  const absl::StatusOr<std::int64_t> application = database.ReadInt("PRAGMA application_id");
  if (!application.ok()) {
    if (!absl::IsDataLoss(application.status())) return application.status();
    return Precondition(database, std::string("is no SQLite file, or a damaged one; it is left as "
                                              "it is")
                                      .append(IfDamaged()));
  }
  constexpr const char* kOthers = "is an SQLite file of another program; it is left as it is";
  if (*application != 0 && *application != kApplicationId) return Precondition(database, kOthers);
  const absl::StatusOr<std::int64_t> version = database.ReadInt("PRAGMA user_version");
  if (!version.ok()) return version.status();
  const auto tables = database.ReadInt("SELECT COUNT(*) FROM sqlite_schema");
  if (!tables.ok()) return tables.status();
  const bool is_empty = *application == 0 && *version == 0 && *tables == 0;
  if (!is_empty && *application != kApplicationId) return Precondition(database, kOthers);
  const auto missing = Missing(database, migrations);
  if (missing.ok() && missing->size() == migrations.size() && *tables > 0) {
    return TablesWithoutSteps("store " + database.path());
  }
  return missing.status();
}

absl::Status ConfigureWriter(Database& database) {
  absl::Status set = Pragma(database, "journal_mode", "WAL", "wal");
  if (set.ok()) set = Pragma(database, "synchronous", kSynchronous.value, kSynchronous.shown);
  if (set.ok()) set = Pragma(database, "temp_store", "MEMORY", "2");
  if (set.ok()) {
    const std::string cache = std::to_string(-kCacheKib);
    set = Pragma(database, "cache_size", cache, cache);
  }
  if (set.ok()) {
    const std::string kept = std::to_string(kWalKeptBytes);
    set = Pragma(database, "journal_size_limit", kept, kept);
  }
  return set;
}

absl::Status Migrate(Database& database, std::span<const Migration> migrations, IfOlder if_older) {
  const absl::StatusOr<std::span<const Migration>> missing = Missing(database, migrations);
  if (!missing.ok() || missing->empty()) return missing.status();
  if (if_older == IfOlder::kRefuse) {
    return Precondition(database,
                        "has schema version " + std::to_string(missing->front().version - 1) +
                            ", and this program needs " + std::to_string(migrations.size()) +
                            ": start the server of this version once, with"
                            " store.migrate on (the default); it migrates the file");
  }
  for (const Migration& migration : *missing) {
    absl::Status applied = Apply(database, migration);
    if (!applied.ok()) return applied;
  }
  return absl::OkStatus();
}

}  // namespace uplink::storage::sqlite
