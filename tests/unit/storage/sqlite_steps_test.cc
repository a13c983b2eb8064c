#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <gtest/gtest.h>

#include "storage/sqlite/database.h"
#include "storage/sqlite/schema.h"
#include "tests/support/temp_folder.h"

// What steps of the schema make of rows that are there.
namespace uplink::storage::sqlite {
namespace {

class SqliteSteps : public ::testing::Test {
 protected:
  SqliteSteps() {
    auto database = Database::Open(folder_.File("uplinkd.db"), Access::kWrite, milliseconds(100));
    EXPECT_TRUE(database.ok()) << database.status();
    if (database.ok()) database_ = *std::move(database);
  }
  /// All steps before the one of this name.
  void MigrateUpTo(std::string_view name) {
    const auto step = std::ranges::find_if(Migrations(), [&](const Migration& migration) {
      return std::string_view(migration.name).ends_with(name);
    });
    ASSERT_NE(step, Migrations().end());
    const auto before = static_cast<std::size_t>(step - Migrations().begin());
    const auto migrated = Migrate(*database_, Migrations().first(before), IfOlder::kMigrate);
    ASSERT_TRUE(migrated.ok()) << migrated;
  }
  void MigrateAll() {
    const auto migrated = Migrate(*database_, Migrations(), IfOlder::kMigrate);
    ASSERT_TRUE(migrated.ok()) << migrated;
  }
  void Run(const std::string& sql) {
    const absl::Status run = database_->Execute(sql);
    ASSERT_TRUE(run.ok()) << run;
  }
  [[nodiscard]] std::int64_t Int(const std::string& sql) { return *database_->ReadInt(sql); }

  testing::TempFolder folder_;
  std::unique_ptr<Database> database_;
};

TEST_F(SqliteSteps, MessagesOfAnEarlierBuildHaveNoDetail) {
  MigrateUpTo("_message_detail");
  Run("INSERT INTO messages (ruri, received_ms, entry, fleet, session, seq, sampled_ms, level,"
      " message) VALUES ('rcan://a', 1, 1, 'f', x'00', 1, 0, 0, 'hello')");
  MigrateAll();
  EXPECT_EQ(Int("SELECT COUNT(*) FROM messages WHERE detail = '' AND message = 'hello'"), 1);
}

TEST_F(SqliteSteps, QuarantineOfAnEarlierBuildCameByTheRelay) {
  MigrateUpTo("_quarantine_source");
  Run("INSERT INTO quarantine VALUES ('rcan://a', x'00', 1, 1, 'f', 1, 1, '', '', 0, NULL)");
  MigrateAll();
  EXPECT_EQ(Int("SELECT COUNT(*) FROM quarantine WHERE source = 0 AND topic = ''"), 1);
}

TEST_F(SqliteSteps, DeliveriesOfSessionsThatWereLostEarlierGo) {
  MigrateUpTo("_lost_sessions");
  Run("INSERT INTO topic_clients VALUES ('c', x'01', 1, 0, 1, 3)");
  Run("INSERT INTO deliveries VALUES ('c', 2, 7, NULL), ('c', 3, 8, NULL)");
  MigrateAll();
  EXPECT_EQ(Int("SELECT SUM(number) FROM deliveries"), 3);
  EXPECT_EQ(Int("SELECT epoch FROM topic_clients"), 1);
}

}  // namespace
}  // namespace uplink::storage::sqlite
