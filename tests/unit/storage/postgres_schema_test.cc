#include <atomic>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "schema/base/clock.h"
#include "storage/postgres/admin.h"
#include "storage/postgres/migrations.h"
#include "storage/postgres/schema.h"
#include "storage/postgres/store.h"
#include "tests/support/eventually.h"
#include "tests/support/postgres_database.h"

namespace uplink::storage::postgres {
namespace {

using testing::DatabaseContent;
using testing::PostgresDatabase;
using testing::PostgresShell;

class PostgresSchemaTest : public ::testing::Test {
 protected:
  std::unique_ptr<Connection> Connect(const std::string& url) {
    ConnectionOptions options;
    options.url = *ParseUrl(url);
    auto connection = Connection::Open(options, clock_);
    EXPECT_TRUE(connection.ok()) << connection.status();
    return *std::move(connection);
  }
  std::unique_ptr<Connection> Owner() { return Connect(database_.owner_url()); }
  void LimitTheOwner() {
    for (const char* timeout : {"statement_timeout", "lock_timeout"}) {
      database_.Shell().Run("ALTER ROLE uplinkd_owner IN DATABASE " + database_.name() + " SET " +
                            timeout + " = '50ms'");
    }
  }
  /// Runs `migrate`, which has to wait for another migration four times as long as LimitTheOwner
  /// lets a statement take.
  void WhileAnotherMigrates(const std::function<void()>& migrate) {
    PostgresShell other = database_.Shell();
    other.Run("SELECT pg_advisory_lock(7593126044910271826)");
    std::atomic<bool> ended{false};
    std::jthread thread([&] {
      migrate();
      ended.store(true);
    });
    EXPECT_TRUE(testing::Eventually([&] {
      return ended.load() || other.Read("SELECT count(*) FROM pg_stat_activity WHERE datname = '" +
                                        database_.name() +
                                        "' AND wait_event_type = 'Lock'"
                                        " AND now() - query_start > interval '200ms'") == "1\n";
    }));
    EXPECT_FALSE(ended.load());
    other.Run("SELECT pg_advisory_unlock(7593126044910271826)");
  }

  const SystemClock clock_{};
  PostgresDatabase database_{DatabaseContent::kEmpty};
};

TEST_F(PostgresSchemaTest, MigratesAnEmptyDatabaseOnce) {
  const auto owner = Owner();
  EXPECT_EQ(ReadSchema(*owner, Migrations())->version, 0);
  const absl::Status before = CheckSchema(*owner, Migrations());
  EXPECT_TRUE(absl::IsFailedPrecondition(before)) << before;
  EXPECT_TRUE(before.message().find("uplinkctl store migrate") != absl::string_view::npos);

  const auto steps = Migrate(*owner, Migrations());
  ASSERT_TRUE(steps.ok()) << steps.status();
  EXPECT_EQ(steps->size(), Migrations().size());
  EXPECT_TRUE(CheckSchema(*owner, Migrations()).ok());
  EXPECT_EQ(Migrate(*owner, Migrations())->size(), 0U);
}

TEST_F(PostgresSchemaTest, NoTimeoutOfTheRoleEndsAMigration) {
  LimitTheOwner();
  absl::Status migrated = absl::UnknownError("not done");
  WhileAnotherMigrates([&] {
    AdminOptions options;
    options.url = database_.owner_url();
    migrated = MigrateStore(options, "uplinkd", clock_).status();
  });
  EXPECT_TRUE(migrated.ok()) << migrated;
}

TEST_F(PostgresSchemaTest, NoTimeoutOfTheRoleEndsTheMigrationOfAStart) {
  LimitTheOwner();
  absl::Status opened = absl::UnknownError("not done");
  WhileAnotherMigrates([&] {
    StoreOptions options;
    options.url = database_.owner_url();
    options.migrate = true;
    const auto store = PostgresStore::Open(std::move(options), clock_);
    opened = store.ok() ? (*store)->open_error() : store.status();
  });
  EXPECT_TRUE(opened.ok()) << opened;
}

TEST_F(PostgresSchemaTest, TwoThatMigrateAtOnceDoItOnce) {
  std::vector<std::size_t> applied(4);
  {
    std::vector<std::jthread> threads;
    threads.reserve(applied.size());
    for (std::size_t& count : applied) {
      threads.emplace_back([this, &count] {
        const auto steps = Migrate(*Owner(), Migrations());
        EXPECT_TRUE(steps.ok()) << steps.status();
        if (steps.ok()) count = steps->size();
      });
    }
  }
  std::size_t sum = 0;
  for (const std::size_t count : applied) sum += count;
  EXPECT_EQ(sum, Migrations().size());
}

TEST_F(PostgresSchemaTest, ANewerOneIsUsedUnlessItShutsThisProgramOut) {
  const auto owner = Owner();
  ASSERT_TRUE(Migrate(*owner, Migrations()).ok());
  PostgresShell shell = database_.Shell();
  shell.Run("INSERT INTO uplinkd.schema_migrations VALUES (99, 1, 'x', 'y')");
  EXPECT_TRUE(CheckSchema(*owner, Migrations()).ok());
  EXPECT_EQ(Migrate(*owner, Migrations())->size(), 0U);

  shell.Run("UPDATE uplinkd.schema_migrations SET oldest = 99 WHERE version = 99");
  const absl::Status newer = CheckSchema(*owner, Migrations());
  EXPECT_TRUE(absl::IsUnimplemented(newer)) << newer;
  EXPECT_TRUE(newer.message().find("run a newer uplinkd") != absl::string_view::npos) << newer;
  EXPECT_TRUE(absl::IsUnimplemented(Migrate(*owner, Migrations()).status()));
}

TEST_F(PostgresSchemaTest, AnotherSchemaAndOneOfAnEarlierBuildAreRefused) {
  const auto owner = Owner();
  ASSERT_TRUE(Migrate(*owner, Migrations()).ok());
  PostgresShell shell = database_.Shell();
  shell.Run("UPDATE uplinkd.schema_migrations SET sha256 = 'other' WHERE version = 1");
  const absl::Status other = CheckSchema(*owner, Migrations());
  EXPECT_TRUE(absl::IsUnimplemented(other)) << other;
  EXPECT_TRUE(other.message().find("another 0001_schema") != absl::string_view::npos);

  shell.Run("ALTER TABLE uplinkd.schema_migrations DROP COLUMN oldest");
  const absl::Status earlier = CheckSchema(*owner, Migrations());
  EXPECT_TRUE(absl::IsUnimplemented(earlier)) << earlier;
  EXPECT_TRUE(earlier.message().find("an earlier build") != absl::string_view::npos) << earlier;
  EXPECT_TRUE(absl::IsUnimplemented(Migrate(*owner, Migrations()).status()));
}

TEST_F(PostgresSchemaTest, TablesWhoseStepsAreGoneAreRefusedAsDamaged) {
  const auto owner = Owner();
  ASSERT_TRUE(Migrate(*owner, Migrations()).ok());
  for (const char* const gone :
       {"DELETE FROM uplinkd.schema_migrations", "DROP TABLE uplinkd.schema_migrations"}) {
    database_.Shell().Run(gone);
    for (const absl::Status& status :
         {CheckSchema(*owner, Migrations()), Migrate(*owner, Migrations()).status()}) {
      EXPECT_TRUE(absl::IsFailedPrecondition(status)) << status;
      EXPECT_TRUE(status.message().find(" is damaged: ") != absl::string_view::npos) << status;
    }
  }
}

TEST_F(PostgresSchemaTest, ARoleThatWasGrantedNothingIsToldHowToBe) {
  ASSERT_TRUE(Migrate(*Owner(), Migrations()).ok());
  const absl::Status denied = CheckSchema(*Connect(database_.url()), Migrations());
  EXPECT_TRUE(absl::IsFailedPrecondition(denied)) << denied;
  EXPECT_TRUE(denied.message().find("--grant-to ROLE") != absl::string_view::npos) << denied;
}

TEST_F(PostgresSchemaTest, AFailedStepLeavesTheStepsBefore) {
  std::vector<Migration> migrations(Migrations().begin(), Migrations().end());
  migrations.push_back({static_cast<std::int64_t>(migrations.size()) + 1, 1, "0002_broken", "sum",
                        "CREATE TABLE half (a int); SELECT nothing_of_this_name();"});
  const auto owner = Owner();
  const auto steps = Migrate(*owner, migrations);
  EXPECT_FALSE(steps.ok());
  EXPECT_TRUE(steps.status().message().find("0002_broken") != absl::string_view::npos);
  EXPECT_EQ(ReadSchema(*owner, Migrations())->version,
            static_cast<std::int64_t>(Migrations().size()));
  EXPECT_EQ(database_.Shell().Read("SELECT to_regclass('uplinkd.half')"), "\n");
}

TEST_F(PostgresSchemaTest, ARoleThatMayNotCreateIsToldSo) {
  const auto server = Connect(database_.url());
  const auto steps = Migrate(*server, Migrations());
  EXPECT_FALSE(steps.ok());
  EXPECT_TRUE(steps.status().message().find("permission denied") != absl::string_view::npos)
      << steps.status();
}

TEST_F(PostgresSchemaTest, LaterStepsAreGrantedToWhoWasGranted) {
  const auto owner = Owner();
  ASSERT_TRUE(Migrate(*owner, Migrations()).ok());
  ASSERT_TRUE(GrantTo(*owner, "uplinkd").ok());
  std::vector<Migration> migrations(Migrations().begin(), Migrations().end());
  migrations.push_back({static_cast<std::int64_t>(migrations.size()) + 1, 1, "0002_more", "sum",
                        "CREATE TABLE more (a int);"});
  ASSERT_TRUE(Migrate(*owner, migrations).ok());
  PostgresShell(database_.url()).Run("INSERT INTO uplinkd.more VALUES (1)");
  EXPECT_EQ(database_.Shell().Read("SELECT has_table_privilege('uplinkd',"
                                   " 'uplinkd.schema_migrations', 'INSERT')"),
            "f\n");
}

TEST(PostgresRoleTest, TheServersRoleDrawsEpochsAndSetsNothingBack) {
  PostgresDatabase database;
  EXPECT_EQ(PostgresShell(database.url()).Read("SELECT nextval('uplinkd.epochs')"), "1\n");
  EXPECT_EQ(database.Shell().Read("SELECT has_sequence_privilege('uplinkd', 'uplinkd.epochs',"
                                  " 'UPDATE')"),
            "f\n");
}

TEST(PostgresRoleTest, WhatRunsAsTheOwnerLooksForNamesInTheSchemaAlone) {
  PostgresDatabase database;
  EXPECT_EQ(database.Shell().Read("SELECT proname FROM pg_proc WHERE prosecdef"
                                  " AND pronamespace = 'uplinkd'::regnamespace AND NOT"
                                  " proconfig @> ARRAY['search_path=uplinkd, pg_temp']"),
            "");
}

TEST(PostgresPartitionsTest, TheServersRoleMakesAndDropsDays) {
  PostgresDatabase database;
  PostgresShell server(database.url());
  // Seven histories; three days of each are there already.
  EXPECT_EQ(server.Read("SELECT uplinkd.make_partitions('2025-11-20', 4)"), "7\n");
  EXPECT_EQ(server.Read("SELECT uplinkd.make_partitions('2025-11-20', 4)"), "0\n");
  EXPECT_EQ(server.Read("SELECT uplinkd.drop_partitions('events', '2025-11-22')"), "2\n");
  EXPECT_EQ(server.Read("SELECT to_regclass('uplinkd.events_20251121') IS NULL,"
                        " to_regclass('uplinkd.events_20251122') IS NULL,"
                        " to_regclass('uplinkd.messages_20251121') IS NULL"),
            "t|f|f\n");
}

TEST(PostgresPartitionsTest, RowsOfTheDefaultMoveIntoTheirDay) {
  PostgresDatabase database;
  database.Shell().Run(
      "INSERT INTO uplinkd.presence_changes VALUES ('rcan://a', '2026-01-02 12:00Z', 1, 'f', 1)");
  EXPECT_EQ(PostgresShell(database.url()).Read("SELECT uplinkd.make_partitions('2026-01-02', 1)"),
            "7\n");
  EXPECT_EQ(database.Shell().Read("SELECT tableoid::regclass FROM uplinkd.presence_changes"),
            "uplinkd.presence_changes_20260102\n");
}

TEST(PostgresPartitionsTest, ADayWithVeryManyRowsInTheDefaultStaysThere) {
  PostgresDatabase database;
  database.Shell().Run(
      "INSERT INTO uplinkd.presence_changes SELECT 'rcan://a', '2026-01-02 12:00Z', n, 'f', 1"
      " FROM generate_series(1, 10001) AS n");
  EXPECT_EQ(PostgresShell(database.url()).Read("SELECT uplinkd.make_partitions('2026-01-02', 1)"),
            "6\n");
  EXPECT_EQ(
      database.Shell().Read("SELECT DISTINCT tableoid::regclass FROM uplinkd.presence_changes"),
      "uplinkd.presence_changes_default\n");
}

/// What the server's role is told when it runs the statement.
absl::Status Try(const PostgresDatabase& database, const std::string& sql) {
  const SystemClock clock;
  ConnectionOptions options;
  options.url = *ParseUrl(database.url());
  const auto connection = Connection::Open(options, clock);
  if (!connection.ok()) return connection.status();
  std::vector<StoreCall> calls;
  calls.push_back({sql, {}});
  return (*connection)->Run(calls, "try").status();
}
bool Refuses(const PostgresDatabase& database, const std::string& sql) {
  return Try(database, sql).message().find("22023") != absl::string_view::npos;
}
// As the functions see it, who take ten minutes before midnight for the next day.
const std::string kToday = "(now() AT TIME ZONE 'UTC')::date";
const std::string kTodayOrTomorrow = "((now() + interval '10 minutes') AT TIME ZONE 'UTC')::date";

TEST(PostgresPartitionsTest, DaysFarAheadAreNotMade) {
  PostgresDatabase database;
  const auto make = [](const std::string& first_day, const std::string& days) {
    return "SELECT uplinkd.make_partitions(" + first_day + ", " + days + ")";
  };
  EXPECT_EQ(PostgresShell(database.url()).Read(make(kToday + " + 30", "2")), "14\n");
  EXPECT_TRUE(Refuses(database, make(kTodayOrTomorrow + " + 32", "1")));
  EXPECT_TRUE(Refuses(database, make(kTodayOrTomorrow + " + 2", "31")));
  EXPECT_TRUE(Refuses(database, make("'infinity'", "1")));
  EXPECT_TRUE(Refuses(database, make("'2999-01-01'", "1")));
}

// What nothing would drop: the name of a partition has no era.
TEST(PostgresPartitionsTest, DaysLongAgoAreNotMade) {
  PostgresDatabase database;
  const auto make = [](const std::string& first_day, const std::string& days) {
    return "SELECT uplinkd.make_partitions(" + first_day + ", " + days + ")";
  };
  EXPECT_EQ(PostgresShell(database.url()).Read(make(kToday + " - 9999", "1")), "7\n");
  EXPECT_TRUE(Refuses(database, make(kToday + " - 10001", "1")));
  EXPECT_TRUE(Refuses(database, make("'4713-01-01 BC'", "31")));
  EXPECT_TRUE(Refuses(database, make("'-infinity'", "1")));
  EXPECT_TRUE(Refuses(database, make("NULL", "1")));
  EXPECT_TRUE(Refuses(database, make(kToday, "NULL")));
}

TEST(PostgresPartitionsTest, DaysNearTodayAreNotDropped) {
  PostgresDatabase database;
  PostgresShell server(database.url());
  const auto drop = [](const std::string& before) {
    return "SELECT uplinkd.drop_partitions('messages', " + before + ")";
  };
  server.Run("SELECT uplinkd.make_partitions(" + kToday + " - 3, 5)");
  EXPECT_TRUE(Refuses(database, drop(kTodayOrTomorrow)));
  EXPECT_TRUE(Refuses(database, drop(kTodayOrTomorrow + " + 1")));
  EXPECT_TRUE(Refuses(database, drop("'infinity'")));
  EXPECT_EQ(server.Read("SELECT uplinkd.drop_partitions('events', " + kToday + " - 2)"), "4\n");
  // Three of the template, and the two days before yesterday.
  EXPECT_EQ(server.Read(drop(kToday + " - 1")), "5\n");
}

// At the least that store.retention.history takes, and with all the days that it makes.
TEST(PostgresPartitionsTest, AServerThatKeepsOneDayIsRefusedNothing) {
  PostgresDatabase database;
  const SystemClock clock;
  StoreOptions options;
  options.url = database.url();
  options.rules.retain_history = std::chrono::days(1);
  options.rules.retain_quarantine = std::chrono::days(1);
  const auto store = PostgresStore::Open(options, clock);
  ASSERT_TRUE(store.ok()) << store.status();
  const auto erased = (*store)->Retain(clock.System());
  EXPECT_TRUE(erased.ok()) << erased.status();
}

TEST(PostgresPartitionsTest, TheServersRoleMayDoNoMore) {
  PostgresDatabase database;
  const auto denied = [&](const std::string& what) {
    return database.Shell().Read("SELECT has_table_privilege('uplinkd', 'uplinkd.robots', '" +
                                 what + "')");
  };
  EXPECT_EQ(denied("TRUNCATE"), "f\n");
  EXPECT_EQ(denied("REFERENCES"), "f\n");
  EXPECT_EQ(database.Shell().Read("SELECT has_schema_privilege('uplinkd', 'uplinkd', 'CREATE'),"
                                  " has_schema_privilege('public', 'uplinkd', 'USAGE'),"
                                  " has_function_privilege('public',"
                                  " 'uplinkd.drop_partitions(text, date)', 'EXECUTE')"),
            "f|f|f\n");
}

}  // namespace
}  // namespace uplink::storage::postgres
