#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include <gtest/gtest.h>

#include "schema/base/clock.h"
#include "storage/postgres/migrations.h"
#include "storage/postgres/schema.h"
#include "tests/support/postgres_database.h"

// What steps of the schema make of rows that are there, and of who serves.
namespace uplink::storage::postgres {
namespace {

using testing::DatabaseContent;
using testing::PostgresDatabase;
using testing::PostgresShell;

class PostgresSteps : public ::testing::Test {
 protected:
  PostgresSteps() {
    ConnectionOptions options;
    options.url = *ParseUrl(database_.owner_url());
    auto connection = Connection::Open(options, clock_);
    EXPECT_TRUE(connection.ok()) << connection.status();
    if (connection.ok()) owner_ = *std::move(connection);
  }
  /// All steps before the one of this name, with the server's role granted.
  void MigrateUpTo(std::string_view name) {
    const auto step = std::ranges::find_if(Migrations(), [&](const Migration& migration) {
      return std::string_view(migration.name).ends_with(name);
    });
    ASSERT_NE(step, Migrations().end());
    const auto before = static_cast<std::size_t>(step - Migrations().begin());
    ASSERT_TRUE(Migrate(*owner_, Migrations().first(before)).ok());
    ASSERT_TRUE(GrantTo(*owner_, "uplinkd").ok());
  }
  void MigrateAll() {
    const auto steps = Migrate(*owner_, Migrations());
    ASSERT_TRUE(steps.ok()) << steps.status();
  }

  const SystemClock clock_{};
  PostgresDatabase database_{DatabaseContent::kEmpty};
  std::unique_ptr<Connection> owner_;
};

TEST_F(PostgresSteps, MessagesOfAnEarlierBuildHaveNoDetail) {
  MigrateUpTo("_message_detail");
  database_.Shell().Run(
      "SELECT uplinkd.make_partitions('2026-01-02', 1);"
      "INSERT INTO uplinkd.messages VALUES ('rcan://a', '2026-01-02 12:00Z', 1, 'f',"
      " '07000000-0000-0000-0000-000000000000', 1, 0, 0, 'hello')");
  MigrateAll();
  EXPECT_EQ(PostgresShell(database_.url())
                .Read("SELECT c.relname, m.message, m.detail FROM uplinkd.messages AS m"
                      " JOIN pg_class AS c ON c.oid = m.tableoid"),
            "messages_20260102|hello|\n");
}

TEST_F(PostgresSteps, QuarantineOfAnEarlierBuildCameByTheRelay) {
  MigrateUpTo("_quarantine_source");
  database_.Shell().Run(
      "SELECT uplinkd.make_partitions('2026-01-02', 1);"
      "INSERT INTO uplinkd.quarantine VALUES ('rcan://a', '07000000-0000-0000-0000-000000000000',"
      " 1, 1, '2026-01-02 12:00Z', 'f', 1, '', '', 0, NULL)");
  MigrateAll();
  EXPECT_EQ(PostgresShell(database_.url()).Read("SELECT source, topic FROM uplinkd.quarantine"),
            "0|\n");
}

TEST_F(PostgresSteps, AServerOfALaterBuildMakesTheDaysOfScopeUpdatesToo) {
  MigrateUpTo("_scope_updates");
  PostgresShell server(database_.url());
  EXPECT_EQ(server.Read("SELECT uplinkd.make_partitions('2026-01-02', 1)"), "6\n");
  MigrateAll();
  EXPECT_EQ(server.Read("SELECT uplinkd.make_partitions('2026-01-02', 1)"), "1\n");
  server.Run(
      "INSERT INTO uplinkd.scope_updates VALUES ('cyberwave:', '2026-01-02 12:00Z', 1, 'f',"
      " '07000000-0000-0000-0000-000000000000', 1, 0, 0, 'e', 't', '{}')");
  EXPECT_EQ(server.Read("SELECT c.relname FROM uplinkd.scope_updates AS u"
                        " JOIN pg_class AS c ON c.oid = u.tableoid"),
            "scope_updates_20260102\n");
  EXPECT_EQ(server.Read("SELECT uplinkd.drop_partitions('scope_updates', '2026-01-03')"), "1\n");
}

TEST_F(PostgresSteps, DeliveriesOfSessionsThatWereLostEarlierGo) {
  MigrateUpTo("_lost_sessions");
  PostgresShell shell = database_.Shell();
  shell.Run(
      "INSERT INTO uplinkd.topic_clients VALUES"
      " ('c', '01000000-0000-0000-0000-000000000000', 1, false, now(), 3)");
  shell.Run(
      "INSERT INTO uplinkd.deliveries VALUES ('c', 2, 7, NULL), ('c', 3, 8, NULL),"
      " ('gone', 9, 7, NULL)");
  MigrateAll();
  EXPECT_EQ(PostgresShell(database_.url()).Read("SELECT client_id, number FROM uplinkd.deliveries"),
            "c|3\n");
}

// docs/operate/database.md says so: its commits fail, and its log has the name.
TEST_F(PostgresSteps, AServerOfABuildBeforeHoldsFindsNoFunctionForItsCommits) {
  MigrateUpTo("_holds");
  PostgresShell server(database_.url());
  const std::string gone =
      "SELECT to_regprocedure('uplinkd.begin_batch(text[], bigint[], text[], uuid[], bigint[],"
      " text[], integer[], integer[], integer[], bigint, bigint, bigint, uuid, bigint)') IS NULL";
  EXPECT_EQ(server.Read(gone), "f\n");
  MigrateAll();
  EXPECT_EQ(server.Read(gone), "t\n");
}

}  // namespace
}  // namespace uplink::storage::postgres
