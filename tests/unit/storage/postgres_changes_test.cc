// What changes of items is noted by triggers, of whichever session and role.
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/base/clock.h"
#include "storage/postgres/link/connection.h"
#include "storage/postgres/parts.h"
#include "tests/support/eventually.h"
#include "tests/support/postgres_database.h"

namespace uplink::storage::postgres {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using testing::PostgresDatabase;
using testing::PostgresShell;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAre;

/// Writes objects of scope fleet, each an upsert.
std::string Upsert(const std::string& id, int scope = 1) {
  return "INSERT INTO uplinkd.objects VALUES ('rcan://robots/a', '" + id +
         "', 'f1', now(), 1, now(), 0, 'name', 0, 0, " + std::to_string(scope) +
         ", 1, '{}', NULL) ON CONFLICT (ruri, id) DO UPDATE SET scope = excluded.scope";
}

ItemKey Key(const std::string& id) { return {PresentKind::kObject, "rcan://robots/a", id}; }

class PostgresChangesTest : public ::testing::Test {
 protected:
  SharedItems& Items() {
    if (items_ == nullptr) {
      StoreOptions options;
      options.url = database_.url();
      items_ = *MakeSharedItems(options, clock_);
    }
    return *items_;
  }
  void Begin() {
    const auto positions = Items().Positions();
    ASSERT_TRUE(positions.ok()) << positions.status();
    positions_ = *positions;
  }
  SharedChanges Changes() {
    auto changes = Items().ChangesSince(positions_);
    EXPECT_TRUE(changes.ok()) << changes.status();
    if (!changes.ok()) return {};
    if (!changes->trimmed) positions_ = changes->positions;
    return *std::move(changes);
  }
  std::vector<ItemKey> Changed() {
    SharedChanges changes = Changes();
    EXPECT_FALSE(changes.trimmed);
    return std::move(changes.keys);
  }
  std::string Count(const std::string& table) {
    return shell_.Read("SELECT count(*) FROM uplinkd." + table);
  }
  /// As Store::Sweep calls it.
  std::string Sweep(std::int64_t kept = std::int64_t{kChangesKept}) {
    return PostgresShell(database_.url())
        .Read("SELECT uplinkd.sweep_changes(" + std::to_string(kept) + ", " +
              std::to_string(kChangeWriterKept.count()) + ", 1000)");
  }
  /// So much time passes for what was noted.
  void Age(std::chrono::minutes time) {
    shell_.Run("UPDATE uplinkd.changes SET noted_at = noted_at - make_interval(mins => " +
               std::to_string(time.count()) + ")");
    positions_.read_at -= time;
    for (auto& [writer, position] : positions_.writers) position.noted_at -= time;
  }

  const SystemClock clock_{};
  PostgresDatabase database_;
  PostgresShell shell_ = database_.Shell();
  // Of the role that serves, two sessions.
  PostgresShell one_{database_.url()};
  PostgresShell other_{database_.url()};
  std::unique_ptr<SharedItems> items_;
  ChangePositions positions_;
};

TEST_F(PostgresChangesTest, ATransactionThatCommitsLateIsReadThoughALaterOnePassedIt) {
  Begin();
  one_.Run("BEGIN");
  one_.Run(Upsert("late"));
  other_.Run(Upsert("soon"));
  EXPECT_THAT(Changed(), ElementsAre(Key("soon")));
  other_.Run(Upsert("soon too"));
  one_.Run("COMMIT");
  EXPECT_THAT(Changed(), UnorderedElementsAre(Key("late"), Key("soon too")));
  EXPECT_THAT(Changed(), IsEmpty());
  EXPECT_THAT(positions_.writers, SizeIs(2));
}

TEST_F(PostgresChangesTest, ARollbackTakesNumbersBackAndADrawnWriterWithThem) {
  Begin();
  for (int i = 0; i < 2; ++i) {
    one_.Run("BEGIN");
    one_.Run(Upsert("undone"));
    one_.Run("ROLLBACK");
    one_.Run(Upsert("kept"));
    one_.Run("BEGIN");
    one_.Run("SAVEPOINT part");
    one_.Run(Upsert("undone"));
    one_.Run("ROLLBACK TO SAVEPOINT part");
    one_.Run(Upsert("kept too"));
    one_.Run("COMMIT");
    EXPECT_THAT(Changed(), ElementsAre(Key("kept"), Key("kept too")));
  }
  EXPECT_EQ(Count("change_writers"), "1\n");
  EXPECT_EQ(shell_.Read("SELECT array_agg(number ORDER BY number) FROM uplinkd.changes"),
            "{1,2,3,4}\n");
}

TEST_F(PostgresChangesTest, TheServersRoleWritesAndOthersThatMayWriteItemsAreNotedToo) {
  Begin();
  one_.Run(Upsert("served"));
  shell_.Run("DELETE FROM uplinkd.objects");
  EXPECT_THAT(Changed(), ElementsAre(Key("served")));
  EXPECT_EQ(Count("changes"), "2\n") << "the superuser's as well";
  EXPECT_EQ(database_.Shell().Read("SELECT has_table_privilege('uplinkd', 'uplinkd.changes',"
                                   " 'TRUNCATE')"),
            "f\n");
}

TEST_F(PostgresChangesTest, AnUpsertOfBothKindsOfRowsNotesEachOnce) {
  one_.Run(Upsert("there", 0));
  Begin();
  one_.Run(
      "INSERT INTO uplinkd.objects SELECT ruri, i, fleet, first_at, entry, received_at, 0, name, 0,"
      " 0, 2, 1, '{}', NULL FROM uplinkd.objects, (VALUES ('there'), ('new')) AS v (i)"
      " ON CONFLICT (ruri, id) DO UPDATE SET scope = excluded.scope");
  EXPECT_THAT(Changed(), UnorderedElementsAre(Key("there"), Key("new")));
  EXPECT_EQ(Count("changes"), "2\n");
}

TEST_F(PostgresChangesTest, AWriterThatIsIdleGoesAndItsSessionBeginsAnew) {
  Begin();
  one_.Run(Upsert("a"));
  EXPECT_THAT(Changed(), SizeIs(1));
  Age(kChangeWriterKept - std::chrono::minutes(1));
  EXPECT_EQ(Sweep(), "0\n");
  Age(std::chrono::minutes(2));
  EXPECT_EQ(Sweep(), "1\n");
  EXPECT_EQ(Count("change_writers"), "0\n");
  Begin();
  one_.Run(Upsert("b"));
  EXPECT_THAT(Changed(), ElementsAre(Key("b"))) << "as another writer: numbers never come again";
  EXPECT_EQ(shell_.Read("SELECT number FROM uplinkd.changes"), "1\n");
}

TEST_F(PostgresChangesTest, WhoReadsAllTheTimeLosesNothingWhenAWriterGoes) {
  Begin();
  one_.Run(Upsert("a"));
  EXPECT_THAT(Changed(), SizeIs(1));
  Age(kChangeWriterKept + std::chrono::minutes(1));
  positions_.read_at += kChangeWriterKept;
  EXPECT_EQ(Sweep(), "1\n");
  EXPECT_THAT(Changed(), IsEmpty());
  EXPECT_THAT(positions_.writers, IsEmpty());
}

TEST_F(PostgresChangesTest, WhoDidNotReadForAsLongIsTold) {
  Begin();
  positions_.read_at -= kChangesReadWithin - std::chrono::minutes(1);
  const ChangePositions begun = positions_;
  EXPECT_FALSE(Changes().trimmed);
  positions_ = begun;
  positions_.read_at -= std::chrono::minutes(2);
  EXPECT_TRUE(Changes().trimmed);
}

TEST_F(PostgresChangesTest, AWriterThatIsNotInAnOlderCopyIsFoundOut) {
  one_.Run(Upsert("a"));
  Begin();
  EXPECT_FALSE(Changes().trimmed);
  shell_.Run("DELETE FROM uplinkd.changes");
  shell_.Run("DELETE FROM uplinkd.change_writers");
  EXPECT_TRUE(Changes().trimmed) << "it cannot have gone for its age";
}

TEST_F(PostgresChangesTest, ASweepLeavesAWriterThatIsAtWork) {
  one_.Run(Upsert("a"));
  Begin();
  Age(kChangeWriterKept + std::chrono::minutes(1));
  positions_.read_at += kChangeWriterKept;
  one_.Run("BEGIN");
  one_.Run(Upsert("b"));
  EXPECT_EQ(Sweep(), "0\n") << "and does not wait";
  one_.Run("COMMIT");
  EXPECT_THAT(Changed(), ElementsAre(Key("b")));
}

TEST_F(PostgresChangesTest, SweepsOfTwoSessionsDoNotWaitForEachOther) {
  one_.Run(Upsert("a"));
  one_.Run(Upsert("a"));
  other_.Run("BEGIN");
  EXPECT_EQ(other_.Read("SELECT uplinkd.sweep_changes(1, 24, 1000)"), "1\n");
  EXPECT_EQ(Sweep(0), "0\n");
  other_.Run("COMMIT");
  EXPECT_EQ(Count("changes"), "1\n");
}

TEST_F(PostgresChangesTest, ATruncationMakesWhoReadsReadAllAnew) {
  one_.Run(Upsert("a"));
  Begin();
  shell_.Run("TRUNCATE uplinkd.objects");
  EXPECT_TRUE(Changes().trimmed);
  Begin();
  EXPECT_THAT(Changed(), IsEmpty());
  one_.Run(Upsert("b"));
  EXPECT_THAT(Changed(), ElementsAre(Key("b")));
  shell_.Run("TRUNCATE uplinkd.shapes");
  EXPECT_TRUE(Changes().trimmed);
}

// A statement is planned once, for a table that may have been empty then: without a limit its plan
// passes over all rows for each key.
TEST_F(PostgresChangesTest, LookingKeysUpReadsNoOtherRowsHoweverTheTableGrew) {
  shell_.Run("ALTER TABLE uplinkd.objects SET (autovacuum_enabled = false)");
  ASSERT_TRUE(Items().Of(std::vector{Key("none")}).ok());
  shell_.Run(
      "INSERT INTO uplinkd.objects SELECT 'rcan://robots/a', 'x' || n, 'f1', now(), n, now(),"
      " 0, 'name', 0, 0, 1, 1, '{}', NULL FROM generate_series(1, 4000) AS n");
  std::vector<ItemKey> keys;
  for (int i = 1; i <= 100; ++i) keys.push_back(Key("x" + std::to_string(i)));
  const auto read = [this] {
    shell_.Run("SELECT pg_stat_clear_snapshot()");
    return std::stol(
        shell_.Read("SELECT coalesce(sum(idx_tup_read), 0) FROM pg_stat_user_indexes"
                    " WHERE relname = 'objects'"));
  };
  const long before = read();
  const auto items = Items().Of(keys);
  ASSERT_TRUE(items.ok()) << items.status();
  EXPECT_THAT(*items, SizeIs(100));
  items_.reset();  // a session tells what it read when it ends
  ASSERT_TRUE(testing::Eventually([&] { return read() >= before + 100; }));
  EXPECT_LT(read(), before + 1000);
}

// What was replaced would stay for as long as a transaction elsewhere is open.
TEST_F(PostgresChangesTest, NoRowIsEverChanged) {
  {
    PostgresShell writer(database_.url());
    for (int i = 0; i < 3; ++i) writer.Run(Upsert("a"));
  }
  const auto counted = [this](const std::string& what) {
    shell_.Run("SELECT pg_stat_clear_snapshot()");
    return shell_.Read("SELECT sum(" + what +
                       ") FROM pg_stat_user_tables WHERE relname IN ('changes', 'change_writers')");
  };
  ASSERT_TRUE(testing::Eventually([&] { return counted("n_tup_ins") == "4\n"; }))
      << "three changes and their writer, once the session has ended";
  EXPECT_EQ(counted("n_tup_upd"), "0\n");
}

}  // namespace
}  // namespace uplink::storage::postgres
