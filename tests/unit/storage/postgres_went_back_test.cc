// A database that was connected to anew, and may lack what it told; sequences that are behind their
// rows.
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "schema/base/clock.h"
#include "storage/postgres/parts.h"
#include "tests/support/eventually.h"
#include "tests/support/records.h"
#include "tests/unit/storage/postgres_fixture.h"

namespace uplink::storage::postgres {
namespace {

class PostgresWentBackTest : public PostgresFixture {
 protected:
  absl::StatusOr<std::vector<Outcome>> Commit(PostgresStore& store, model::Seq seq,
                                              Epoch held_since) {
    Batch batch;
    batch.records = {{robot_, session_, seq, held_since, FromUnixMs(kNowMs),
                      QuarantineItem{{model::RejectReason::kMalformed, "f", "d"}}, "bytes", 5}};
    return store.Commit(batch);
  }
  /// Ends the sessions of the server's role, as a failover does.
  void EndSessions() {
    shell_.Run("SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE datname = '" +
               database_.name() + "' AND usename = 'uplinkd'");
    EXPECT_TRUE(testing::Eventually([this] {
      return shell_.Read("SELECT count(*) FROM pg_stat_activity WHERE datname = '" +
                         database_.name() + "' AND usename = 'uplinkd'") == "0\n";
    }));
  }
  /// As logical replication leaves them on a new subscriber.
  void LeaveSequencesBehind() {
    shell_.Run(
        "SELECT setval('uplinkd.batches', 1, false), setval('uplinkd.epochs', 1, false),"
        " setval('uplinkd.forget_requests_number_seq', 1, false)");
  }
};

TEST_F(PostgresWentBackTest, NothingIsCommittedOverANewConnectionBeforeItWasCompared) {
  const auto store = Store();
  EXPECT_FALSE(store->InDoubt());
  const Epoch held = Open(*store).held_since;
  ASSERT_TRUE(Commit(*store, 4, held).ok());
  EndSessions();
  EXPECT_TRUE(absl::IsUnavailable(Commit(*store, 5, held).status()));
  EXPECT_TRUE(store->InDoubt());
  // A standby that lagged has taken over.
  shell_.Run("UPDATE uplinkd.sessions SET cursor_seq = 3 WHERE ruri = 'rcan://robots/a'");
  for (int tries = 0; tries < 3; ++tries) {
    EXPECT_TRUE(absl::IsUnavailable(Commit(*store, 5, held).status()));
  }
  const ToldRobot told{.ruri = robot_->ruri, .held_since = held, .sessions = {{session_, 4}}};
  const auto found = store->Compare({&told, 1});
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_TRUE(found->front().held);
  EXPECT_TRUE(found->front().went_back);
  EXPECT_TRUE(store->InDoubt()) << "until the caller has followed that";
  store->EndDoubt();
  EXPECT_FALSE(store->InDoubt());
  EXPECT_TRUE(Commit(*store, 5, held).ok());
}

TEST_F(PostgresWentBackTest, AServerIsKnownAgainAndAnotherDatabaseIsNot) {
  const auto store = Store();
  const std::string run = store->ServerRun();
  EXPECT_FALSE(run.empty());
  const Epoch held = Open(*store).held_since;
  EndSessions();
  EXPECT_FALSE(Commit(*store, 5, held).ok());
  ASSERT_TRUE(store->Compare({}).ok());
  EXPECT_EQ(store->ServerRun(), run) << "its sessions had ended";
  const PostgresDatabase restored;
  StoreOptions options;
  options.url = restored.url();
  EXPECT_NE((*PostgresStore::Open(std::move(options), clock_))->ServerRun(), run);
}

TEST_F(PostgresWentBackTest, AConnectionThatBreaksAgainIsInDoubtAgain) {
  const auto store = Store();
  const Epoch held = Open(*store).held_since;
  EndSessions();
  EXPECT_FALSE(Commit(*store, 5, held).ok());
  ASSERT_TRUE(store->Compare({}).ok());
  EndSessions();
  EXPECT_FALSE(store->Compare(std::vector<ToldRobot>(1)).ok());
  store->EndDoubt();
  EXPECT_TRUE(store->InDoubt()) << "what was compared is not what is connected to next";
}

TEST_F(PostgresWentBackTest, TheFirstConnectionIsInNoDoubt) {
  StoreOptions options = Options();
  options.connect_now = false;
  const auto store = Store(std::move(options));
  EXPECT_FALSE(store->InDoubt());
  EXPECT_EQ(Open(*store).cursor, 0U);
  EXPECT_FALSE(store->InDoubt());
}

TEST_F(PostgresWentBackTest, RejectsAreToldThoughTheirSequenceWasLeftBehind) {
  Epoch held = 0;
  {
    const auto store = Store();
    // So that the session's row names a number that is not among the first.
    shell_.Run("SELECT setval('uplinkd.batches', 1000)");
    held = Open(*store).held_since;
    ASSERT_TRUE(Commit(*store, 1, held).ok());
  }
  LeaveSequencesBehind();
  const auto store = Store();
  const OpenResult opened = Open(*store);
  EXPECT_EQ(opened.held_since, held);
  EXPECT_EQ(opened.rejects.size(), 1U);
  ASSERT_TRUE(Commit(*store, 2, held).ok());
  EXPECT_EQ(Open(*store).rejects.size(), 2U) << "its entry is above the session's first";
  EXPECT_EQ(shell_.Read("SELECT count(*) FROM uplinkd.quarantine AS q JOIN uplinkd.sessions AS s"
                        " USING (ruri, session) WHERE q.entry < s.first_entry"),
            "0\n");
}

TEST_F(PostgresWentBackTest, EpochsAreAboveAllThatRowsName) {
  {
    const auto store = Store();
    shell_.Run("SELECT setval('uplinkd.epochs', 500)");
    EXPECT_EQ(Open(*store).epoch, 501U);
  }
  // Of a lease on topics, which is drawn from the same sequence.
  shell_.Run(
      "INSERT INTO uplinkd.topic_clients (client_id, process, epoch, released, taken_at)"
      " VALUES ('c', gen_random_uuid(), 700, true, now())");
  LeaveSequencesBehind();
  const auto store = Store();
  const auto leases = *MakeTopicLeases(Options(), clock_);
  const auto epoch = leases->Take({.client_id = "c", .prefixes = {""}, .at = FromUnixMs(kNowMs)});
  ASSERT_TRUE(epoch.ok()) << epoch.status();
  EXPECT_EQ(**epoch, 701U);
}

TEST_F(PostgresWentBackTest, ARequestToForgetARobotGetsANumberThatNoneHas) {
  shell_.Run(
      "INSERT INTO uplinkd.forget_requests (ruri, end_stream) VALUES ('rcan://x', false), "
      "('rcan://y', false)");
  LeaveSequencesBehind();
  const auto store = Store();
  shell_.Run("INSERT INTO uplinkd.forget_requests (ruri, end_stream) VALUES ('rcan://z', false)");
  EXPECT_EQ(shell_.Read("SELECT number FROM uplinkd.forget_requests ORDER BY number"), "1\n2\n3\n");
}

TEST_F(PostgresWentBackTest, RowsOfTheAuditAreAboveThoseThatAreThere) {
  AuditRow row;
  row.at = FromUnixMs(kNowMs);
  row.action = "first";
  {
    const auto store = Store();
    shell_.Run("SELECT setval('uplinkd.batches', 1000)");
    ASSERT_TRUE((*MakeAccessStore(Options(), clock_))->Append(row).ok());
  }
  LeaveSequencesBehind();
  row.action = "second";
  ASSERT_TRUE((*MakeAccessStore(Options(), clock_))->Append(row).ok());
  EXPECT_EQ(shell_.Read("SELECT action FROM uplinkd.audit ORDER BY at, entry"), "first\nsecond\n");
}

TEST_F(PostgresWentBackTest, SequencesThatAreNotBehindStayAsTheyAre) {
  const auto store = Store();
  ASSERT_TRUE(Commit(*store, 1, Open(*store).held_since).ok());
  const std::string query = "SELECT last_value FROM uplinkd.batches, (SELECT) AS x";
  const std::string before = shell_.Read(query);
  EXPECT_EQ(shell_.Read("SELECT uplinkd.raise_sequences()"), "f\n");
  EXPECT_EQ(shell_.Read(query), before);
}

// There may be millions, and a failover waits for each connect.
TEST_F(PostgresWentBackTest, TheGreatestEntryOfKeptRejectsComesFromAnIndex) {
  shell_.Run("SET enable_seqscan = off");
  EXPECT_NE(shell_.Read("EXPLAIN (COSTS OFF) SELECT max(k.entry) FROM uplinkd.kept_rejects AS k")
                .find("using kept_rejects_by_entry"),
            std::string::npos);
}

TEST_F(PostgresWentBackTest, EverySequenceOfTheSchemaIsRaised) {
  EXPECT_EQ(shell_.Read("SELECT string_agg(sequencename, ' ' ORDER BY sequencename)"
                        " FROM pg_sequences WHERE schemaname = 'uplinkd'"),
            "batches epochs forget_requests_number_seq\n")
      << "a further one belongs into raise_sequences, too";
}

}  // namespace
}  // namespace uplink::storage::postgres
