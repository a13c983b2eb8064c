// A transaction that somebody holds open keeps all dead versions of the cursors' rows.
#include <memory>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "schema/base/clock.h"
#include "storage/postgres/link/connection.h"
#include "tests/support/eventually.h"
#include "tests/support/records.h"
#include "tests/unit/storage/postgres_fixture.h"

namespace uplink::storage::postgres {
namespace {

class PostgresSnapshotTest : public PostgresFixture {
 protected:
  /// Opens the robot and commits so many batches of one message, from `first` on, by a connection
  /// of its own.
  void CommitMany(model::Seq first, int batches) {
    const auto store = Store();
    const Epoch held = Open(*store).held_since;
    for (int i = 0; i < batches; ++i) {
      const auto outcomes =
          store->Commit(BatchOf({Note(first + static_cast<model::Seq>(i), held)}));
      ASSERT_TRUE(outcomes.ok()) << outcomes.status();
      ASSERT_EQ(outcomes->front().kind, OutcomeKind::kStored);
    }
  }
  /// Pages of a table and of its index that sessions of the server's role have read since the
  /// database was made, as the server counts it when they end.
  int PagesRead(const std::string& table = "sessions") {
    EXPECT_TRUE(testing::Eventually([this] {
      return shell_.Read(
                 "SELECT count(*) FROM pg_stat_activity WHERE usename = 'uplinkd'"
                 " AND datname = current_database()") == "0\n";
    }));
    return std::stoi(
        shell_.Read("SELECT heap_blks_hit + heap_blks_read + idx_blks_hit + idx_blks_read"
                    " FROM pg_statio_user_tables WHERE relname = '" +
                    table + "'"));
  }
};

TEST_F(PostgresSnapshotTest, ACommitReadsNoMorePagesForDeadVersionsOfItsCursor) {
  constexpr int kBatches = 100;
  constexpr int kDead = 20'000;
  CommitMany(1, kBatches);
  const int fresh = PagesRead();
  PostgresShell other = database_.Shell();
  other.Run("BEGIN ISOLATION LEVEL REPEATABLE READ");
  static_cast<void>(other.Read("SELECT 1"));
  // As so many commits leave them, in the order of their numbers.
  shell_.Run(
      "DO $$ DECLARE at tid; BEGIN SELECT ctid INTO at FROM uplinkd.sessions"
      " WHERE ruri = 'rcan://robots/a'; FOR i IN 1 .. " +
      std::to_string(kDead) +
      " LOOP UPDATE uplinkd.sessions SET cursor_seq = cursor_seq + 1 WHERE ctid = at"
      " RETURNING ctid INTO at; END LOOP; END $$");
  EXPECT_EQ(shell_.Read("SELECT cursor_seq FROM uplinkd.sessions WHERE ruri = 'rcan://robots/a'"),
            std::to_string(kBatches + kDead) + "\n");
  EXPECT_TRUE(testing::Eventually([this] {
    shell_.Run("SELECT pg_stat_clear_snapshot()");
    return shell_.Read(
               "SELECT n_tup_upd >= 20000 FROM pg_stat_user_tables"
               " WHERE relname = 'sessions'") == "t\n";
  }));
  const int before = PagesRead();
  CommitMany(kBatches + kDead + 1, kBatches);
  EXPECT_LE(PagesRead() - before, 2 * fresh);
}

TEST_F(PostgresSnapshotTest, ACommitLooksForItsRobotsAloneHoweverManyThereAre) {
  constexpr int kBatches = 100;
  CommitMany(1, kBatches);
  const int robots = PagesRead("robots");
  const int sessions = PagesRead("sessions");
  shell_.Run(
      "INSERT INTO uplinkd.robots (ruri, fleet, epoch, held_since, owner, first_seen, last_seen)"
      " SELECT 'rcan://others/' || i, 'f', 1, 1, gen_random_uuid(), now(), now()"
      " FROM generate_series(1, 5000) AS i");
  shell_.Run(
      "INSERT INTO uplinkd.sessions (ruri, session, cursor_seq, last_used, first_entry)"
      " SELECT ruri, owner, 1, now(), 0 FROM uplinkd.robots WHERE ruri LIKE 'rcan://others/%'");
  EXPECT_TRUE(testing::Eventually([this] {
    shell_.Run("SELECT pg_stat_clear_snapshot()");
    return shell_.Read(
               "SELECT count(*) FROM pg_stat_user_tables WHERE n_tup_ins >= 5000"
               " AND relname IN ('robots', 'sessions')") == "2\n";
  }));
  const int robots_before = PagesRead("robots");
  const int sessions_before = PagesRead("sessions");
  CommitMany(kBatches + 1, kBatches);
  // Two levels more of each index, which a commit goes down a few times.
  constexpr int kLevels = 8 * kBatches;
  EXPECT_LE(PagesRead("robots") - robots_before, robots + kLevels);
  EXPECT_LE(PagesRead("sessions") - sessions_before, sessions + kLevels);
}

}  // namespace
}  // namespace uplink::storage::postgres
