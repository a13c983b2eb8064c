#include <fstream>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "schema/base/clock.h"
#include "tests/support/eventually.h"
#include "tests/support/fault_proxy.h"
#include "tests/support/records.h"
#include "tests/support/temp_folder.h"
#include "tests/unit/storage/postgres_fixture.h"

namespace uplink::storage::postgres {
namespace {

using testing::FaultProxy;

/// One robot and one session on a real database, as the role that serves.
class PostgresBatchTest : public PostgresFixture {
 protected:
  static std::vector<OutcomeKind> Kinds(const absl::StatusOr<std::vector<Outcome>>& outcomes) {
    EXPECT_TRUE(outcomes.ok()) << outcomes.status();
    std::vector<OutcomeKind> kinds;
    if (!outcomes.ok()) return kinds;
    for (const Outcome& outcome : *outcomes) kinds.push_back(outcome.kind);
    return kinds;
  }
};

TEST_F(PostgresBatchTest, ABatchWithoutTroubleIsWrittenAtOnce) {
  const auto store = Store(1);
  const Epoch held = Open(*store).held_since;
  // What the other ways need first is taken away.
  database_.Shell().Run("REVOKE INSERT ON uplinkd.sessions FROM uplinkd");
  EXPECT_EQ(Kinds(store->Commit(BatchOf({Note(1, held), Note(2, held)}))),
            (std::vector{OutcomeKind::kStored, OutcomeKind::kStored}));
  // A duplicate needs the look, which fails now: so the first went without.
  EXPECT_FALSE(store->Commit(BatchOf({Note(2, held)})).ok());
}

// The database says that it must be read first, and is gone before the transaction is rolled back.
TEST_F(PostgresBatchTest, AConnectionThatEndsWithARollbackIsNotUsedAgain) {
  FaultProxy proxy(static_cast<std::uint16_t>(std::stoi(database_.cluster().port)));
  const testing::TempFolder folder;
  StoreOptions options = Options();
  options.url = "postgresql://uplinkd@127.0.0.1:" + std::to_string(proxy.port()) + "/" +
                database_.name() + "?sslmode=disable&gssencmode=disable";
  options.password_file = folder.File("password");
  std::ofstream(options.password_file) << "uplinkd\n";
  const auto store = Store(std::move(options));
  const Epoch held = Open(*store).held_since;
  ASSERT_EQ(Kinds(store->Commit(BatchOf({Note(1, held)}))), std::vector{OutcomeKind::kStored});
  proxy.CutNextRollback();
  // A duplicate, so that the batch cannot be written at once.
  const auto cut = store->Commit(BatchOf({Note(1, held), Note(2, held)}));
  EXPECT_TRUE(absl::IsUnavailable(cut.status())) << cut.status();
  EXPECT_EQ(proxy.cuts(), 1);
  ASSERT_TRUE(store->InDoubt());
  ASSERT_TRUE(store->Compare({}).ok());
  store->EndDoubt();
  EXPECT_EQ(Kinds(store->Commit(BatchOf({Note(1, held), Note(2, held)}))),
            (std::vector{OutcomeKind::kDuplicate, OutcomeKind::kStored}));
}

TEST_F(PostgresBatchTest, RowsLieInThePartitionOfTheirDay) {
  const auto store = Store(1);
  const Epoch held = Open(*store).held_since;
  CommitRecord late = Note(2, held);
  late.received_at = FromUnixMs(kNowMs + 10LL * 86'400'000);
  ASSERT_EQ(Kinds(store->Commit(BatchOf({Note(1, held), late}))).size(), 2U);
  EXPECT_EQ(database_.Shell().Read("SELECT tableoid::regclass, seq FROM uplinkd.messages"
                                   " ORDER BY seq"),
            "uplinkd.messages_20251121|1\nuplinkd.messages_default|2\n");
}

TEST_F(PostgresBatchTest, AnOpenThatWaitsForACommitSeesItsCursor) {
  const auto older = Store(1);
  const auto newer = Store(2);
  const Epoch held = Open(*older).held_since;
  // A commit of the older process that stands still with its locks held.
  PostgresShell commit(database_.url());
  commit.Run("BEGIN");
  commit.Run("SELECT uplinkd.begin_batch(ARRAY['rcan://robots/a'], ARRAY[" + std::to_string(held) +
             "]::bigint[], ARRAY['rcan://robots/a'],"
             " ARRAY['07000000-0000-0000-0000-000000000000']::uuid[], ARRAY[9]::bigint[], '{}',"
             " '{}', '{}', '{}', 1, 1, 1, NULL, NULL, '01000000-0000-0000-0000-000000000000')");
  commit.Run("UPDATE uplinkd.sessions SET cursor_seq = 9");
  OpenResult opened;
  std::jthread open([&] { opened = Open(*newer); });
  ASSERT_TRUE(testing::Eventually([this] {
    return database_.Shell().Read(
               "SELECT count(*) FROM pg_stat_activity WHERE wait_event_type ="
               " 'Lock' AND datname = current_database()") == "1\n";
  }));
  commit.Run("COMMIT");
  open.join();
  EXPECT_EQ(opened.cursor, 9U);
  EXPECT_GT(opened.held_since, held);
}

TEST_F(PostgresBatchTest, TextsThatTheDatabaseRefusesAreIsolated) {
  const auto store = Store(1);
  const Epoch held = Open(*store).held_since;
  database_.Shell().Run("ALTER TABLE uplinkd.messages ADD CHECK (message NOT LIKE 'bad%')");
  std::vector<CommitRecord> records;
  for (model::Seq seq = 1; seq <= 40; ++seq) {
    records.push_back(Note(seq, held, seq % 13 == 0 ? "bad " + std::to_string(seq) : "good"));
  }
  const auto outcomes = store->Commit(BatchOf(std::move(records)));
  const std::vector<OutcomeKind> kinds = Kinds(outcomes);
  ASSERT_EQ(kinds.size(), 40U);
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    const bool is_bad = (i + 1) % 13 == 0;
    EXPECT_EQ(kinds[i], is_bad ? OutcomeKind::kRefused : OutcomeKind::kStored) << i;
    if (!is_bad) continue;
    EXPECT_EQ((*outcomes)[i].rejection->reason, model::RejectReason::kStoreRefused);
  }
  EXPECT_EQ(database_.Shell().Read("SELECT count(*), max(seq) FROM uplinkd.messages"), "37|40\n");
  EXPECT_EQ(database_.Shell().Read("SELECT seq FROM uplinkd.quarantine ORDER BY seq"),
            "13\n26\n39\n");
  EXPECT_EQ(Open(*store).cursor, 40U);
}

TEST_F(PostgresBatchTest, AFullDiskIsToldAndNothingIsKept) {
  const auto store = Store(1);
  const Epoch held = Open(*store).held_since;
  database_.Shell().Run(
      "CREATE FUNCTION uplinkd.fill() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN RAISE EXCEPTION"
      " 'could not extend file: No space left on device' USING ERRCODE = '53100'; END $$;"
      "CREATE TRIGGER fill BEFORE INSERT ON uplinkd.messages FOR EACH ROW"
      " EXECUTE FUNCTION uplinkd.fill()");
  const auto full = store->Commit(BatchOf({Note(1, held)}));
  EXPECT_TRUE(absl::IsResourceExhausted(full.status())) << full.status();
  EXPECT_TRUE(full.status().message().find(database_.name()) != absl::string_view::npos)
      << full.status();
  database_.Shell().Run("DROP TRIGGER fill ON uplinkd.messages");
  EXPECT_EQ(Kinds(store->Commit(BatchOf({Note(1, held)}))), std::vector{OutcomeKind::kStored});
}

TEST_F(PostgresBatchTest, AClockThatNobodyVouchesForMakesThePartitionsOfTheDatabasesDays) {
  const auto store = Store(1);
  const Epoch held = Open(*store).held_since;
  ASSERT_EQ(Kinds(store->Commit(BatchOf({Note(1, held)}))), std::vector{OutcomeKind::kStored});
  trust_.Set(false);
  const SystemTime jumped = clock_.System() + std::chrono::days(1000);
  const auto partitions = [&](const std::string& from) {
    return database_.Shell().Read(
        "SELECT count(*) FROM pg_class WHERE relname ~ '^messages_[0-9]+$' AND to_date(right("
        "relname, 8), 'YYYYMMDD') >= (now() AT TIME ZONE 'UTC')::date + " +
        from);
  };
  database_.Shell().Run(
      "DO $$ BEGIN EXECUTE format('DROP TABLE uplinkd.messages_%s', to_char((now() AT TIME ZONE"
      " 'UTC')::date + 2, 'YYYYMMDD')); END $$");
  ASSERT_EQ(partitions("0"), "3\n");
  const auto retained = store->Retain(jumped);
  ASSERT_TRUE(retained.ok()) << retained.status();
  EXPECT_EQ(retained->rows, 0U);
  EXPECT_EQ(partitions("0"), "4\n") << "made again";
  EXPECT_EQ(partitions("4"), "0\n") << "and none of the days of the jump";
  EXPECT_EQ(database_.Shell().Read("SELECT count(*) FROM uplinkd.messages"), "1\n");
  trust_.Set(true);
  EXPECT_FALSE(store->Retain(jumped).ok()) << "the database's clock bounds what goes, too";
  EXPECT_EQ(database_.Shell().Read("SELECT count(*) FROM uplinkd.messages"), "1\n");
}

TEST_F(PostgresBatchTest, ADeadlockIsTriedAgain) {
  const auto store = Store(1);
  const Epoch held = Open(*store).held_since;
  database_.Shell().Run(
      "CREATE SEQUENCE uplinkd.tries; GRANT USAGE ON SEQUENCE uplinkd.tries TO uplinkd;"
      "CREATE FUNCTION uplinkd.collide() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN"
      " IF nextval('uplinkd.tries') < 3 THEN RAISE EXCEPTION 'deadlock detected'"
      " USING ERRCODE = '40P01'; END IF; RETURN NEW; END $$;"
      "CREATE TRIGGER collide BEFORE INSERT ON uplinkd.messages FOR EACH ROW"
      " EXECUTE FUNCTION uplinkd.collide()");
  EXPECT_EQ(Kinds(store->Commit(BatchOf({Note(1, held)}))), std::vector{OutcomeKind::kStored});
  EXPECT_EQ(database_.Shell().Read("SELECT count(*) FROM uplinkd.messages"), "1\n");
}

TEST_F(PostgresBatchTest, ACheckpointChangesItsRowInPlace) {
  const auto store = Store(1);
  LiveRow row;
  row.ruri = robot_->ruri;
  row.held_since = Open(*store).held_since;
  // Bytes that do not compress: PostgreSQL stores them apart.
  std::string& extras = row.parts[static_cast<std::size_t>(LivePart::kExtras)].emplace();
  std::mt19937 bytes;
  while (extras.size() < 100'000) extras.push_back(static_cast<char>(bytes()));
  ASSERT_TRUE(store->Checkpoint({&row, 1}).ok());
  row.parts[static_cast<std::size_t>(LivePart::kExtras)].reset();
  const auto apart = [&] {
    return database_.Shell().Read(
        "SELECT pg_relation_size(reltoastrelid) FROM pg_class WHERE oid = "
        "'uplinkd.live'::regclass");
  };
  const std::string before = apart();
  EXPECT_GT(std::stoi(before), 100'000);
  std::int64_t now_ms = kNowMs;
  const auto pages_of_a_burst = [&] {
    const auto size = [&] {
      return std::stoi(database_.Shell().Read("SELECT pg_relation_size('uplinkd.live')"));
    };
    const int at_first = size();
    for (int i = 0; i < 100; ++i) {
      row.last_sign_of_life = FromUnixMs(++now_ms);
      row.parts[static_cast<std::size_t>(LivePart::kMotion)] = std::string(150, 'm');
      EXPECT_TRUE(store->Checkpoint({&row, 1}).ok());
    }
    return size() - at_first;
  };
  // A hundred versions, three pages of them, find room where older ones were. Updates tidy up by
  // themselves only when no session of the whole cluster, where other tests run, may still see
  // those; VACUUM asks for this database alone.
  EXPECT_TRUE(testing::Eventually([&] {
    const bool in_place = pages_of_a_burst() == 0;
    database_.Shell().Run("VACUUM (TRUNCATE false) uplinkd.live");
    return in_place;
  }));
  // What did not change was not written again.
  EXPECT_EQ(apart(), before);
}

}  // namespace
}  // namespace uplink::storage::postgres
