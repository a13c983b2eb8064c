#include "storage/sqlite/schema.h"

#include <memory>
#include <string>
#include <string_view>

#include "schema/base/check.h"
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

absl::Status CheckSums(Database& database, std::span<const Migration> migrations,
                       std::int64_t version) {
  if (version == 0) return absl::OkStatus();
  auto statement =
      database.Prepare("SELECT version, name, sha256 FROM schema_migrations ORDER BY version");
  if (!statement.ok()) return statement.status();
  Rows rows = (*statement)->Select();
  for (std::int64_t i = 0; i < version; ++i) {
    const absl::StatusOr<bool> found = rows.Next();
    if (!found.ok()) return found.status();
    const Migration& ours = migrations[static_cast<std::size_t>(i)];
    if (!*found || rows.Int(0) != ours.version || rows.Bytes(2) != ours.sha256) {
      return Precondition(database, "was migrated by another " + std::string(ours.name) +
                                        " than this program's; restore it from a backup");
    }
  }
  return absl::OkStatus();
}

absl::Status Apply(Database& database, const Migration& migration) {
  std::string sql = "BEGIN IMMEDIATE;\n";
  sql += migration.sql;
  sql += "\nINSERT INTO schema_migrations (version, name, sha256) VALUES (" +
         std::to_string(migration.version) + ", '" + migration.name + "', '" + migration.sha256 +
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
                                      .append(kIfDamaged));
  }
  constexpr const char* kOthers = "is an SQLite file of another program; it is left as it is";
  if (*application != 0 && *application != kApplicationId) return Precondition(database, kOthers);
  const absl::StatusOr<std::int64_t> version = database.ReadInt("PRAGMA user_version");
  if (!version.ok()) return version.status();
  const absl::StatusOr<std::int64_t> tables =
      database.ReadInt("SELECT COUNT(*) FROM sqlite_schema");
  if (!tables.ok()) return tables.status();
  const bool is_empty = *application == 0 && *version == 0 && *tables == 0;
  if (!is_empty && *application != kApplicationId) return Precondition(database, kOthers);
  const auto known = static_cast<std::int64_t>(migrations.size());
  if (*version > known) {
    return Precondition(database, "has schema version " + std::to_string(*version) +
                                      ", and this program knows versions up to " +
                                      std::to_string(known) + ": run the newer uplinkd");
  }
  return absl::OkStatus();
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
  const absl::StatusOr<std::int64_t> version = database.ReadInt("PRAGMA user_version");
  if (!version.ok()) return version.status();
  const auto known = static_cast<std::int64_t>(migrations.size());
  UPLINK_CHECK(*version >= 0 && *version <= known, "CheckFile goes before Migrate");
  absl::Status status = CheckSums(database, migrations, *version);
  if (!status.ok()) return status;
  if (*version < known && if_older == IfOlder::kRefuse) {
    return Precondition(
        database, "has schema version " + std::to_string(*version) + ", and this program needs " +
                      std::to_string(known) +
                      ": start the server of this version once, with store.migrate on "
                      "(the default); it migrates the file");
  }
  for (const Migration& migration : migrations.subspan(static_cast<std::size_t>(*version))) {
    status = Apply(database, migration);
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

}  // namespace uplink::storage::sqlite
