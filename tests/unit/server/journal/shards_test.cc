#include "server/journal/shards.h"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/journal/journal_bench.h"

namespace uplink::journal {
namespace {

TEST(ShardsTest, ARobotIsAlwaysInTheSameJournal) {
  JournalBench a;
  JournalBench b;
  const Shards shards({&a.journal, &b.journal});
  std::set<const Journal*> used;
  for (int i = 0; i < 100; ++i) {
    const std::string ruri = "rcan://robots/" + std::to_string(i);
    EXPECT_EQ(&shards.Of(ruri), &shards.Of(ruri));
    used.insert(&shards.Of(ruri));
  }
  EXPECT_EQ(used.size(), 2U) << "all robots are in one journal";
}

TEST(ShardsTest, FiguresAreThoseOfAllJournals) {
  JournalBench a;
  JournalBench b;
  const Shards shards({&a.journal, &b.journal});
  EXPECT_TRUE(shards.idle());
  RecordingClient client("rcan://a");
  a.Append(client, 1, "1234");
  a.clock.Advance(milliseconds(5));
  b.Append(client, 1, "1234");
  EXPECT_EQ(shards.records(), 2U);
  EXPECT_EQ(shards.bytes(), a.journal.bytes() + b.journal.bytes());
  EXPECT_EQ(shards.oldest(a.clock.Steady()), milliseconds(5));
  EXPECT_FALSE(shards.idle());
}

TEST(ShardsTest, TheWorstIsTheFullestJournal) {
  JournalBench a;
  JournalBench b;
  const Shards shards({&a.journal, &b.journal});
  EXPECT_EQ(shards.records_worst(), 0U);
  RecordingClient client("rcan://a");
  a.Append(client, 1, "1234");
  b.Append(client, 1, "1234");
  b.Append(client, 2, "12345678");
  EXPECT_EQ(shards.records_worst(), 2U);
  EXPECT_EQ(shards.bytes_worst(), b.journal.bytes());
}

TEST(ShardsTest, TheErrorOfAnyJournalIsToldWithItsShard) {
  JournalBench a;
  JournalBench b;
  const Shards shards({&a.journal, &b.journal});
  EXPECT_TRUE(shards.last_error().ok());
  RecordingClient client("rcan://a");
  b.Open(client);
  b.store.FailNextOpens(1, testing::FailAt::kBefore, absl::UnavailableError("away"));
  EXPECT_EQ(b.journal.turns().Advance(), Step::kFailed);
  EXPECT_EQ(shards.last_error(), absl::UnavailableError("shard 1 of 2: away"));
  EXPECT_EQ(Shards({&b.journal}).last_error(), absl::UnavailableError("away")) << "the only one";
  EXPECT_EQ(b.journal.turns().Advance(), Step::kWorked);
  EXPECT_TRUE(shards.last_error().ok());
}

TEST(ShardsTest, OneProbeCountsTheJournalsThatFail) {
  testing::FakeDatabase database;
  testing::FakeStore store(database, storage::ProcessId{1});
  testing::ManualClock clock;
  metrics::Ledger ledger;
  JournalProbe probe;
  Journal a(store, {}, clock, ledger, probe, storage::ProcessId{1});
  Journal b(store, {}, clock, ledger, probe, storage::ProcessId{2});
  RecordingClient client("rcan://a");
  store.FailNextOpens(3, testing::FailAt::kBefore);
  for (Journal* journal : {&a, &b}) {
    journal->Open(client, 1, {.robot = client.robot(), .at = clock.System()});
    EXPECT_EQ(journal->turns().Advance(), Step::kFailed);
  }
  EXPECT_EQ(a.turns().Advance(), Step::kFailed);
  EXPECT_EQ(probe.store_failing.value(), 2);
  EXPECT_EQ(a.turns().Advance(), Step::kWorked);
  EXPECT_EQ(probe.store_failing.value(), 1) << "one works, the other does not";
  EXPECT_EQ(b.turns().Advance(), Step::kWorked);
  EXPECT_EQ(probe.store_failing.value(), 0);
}

TEST(ShardsTest, TheBoundsAreSharedOut) {
  JournalLimits all;
  all.bytes_max = 1001;
  all.records_max = 1;
  const JournalLimits share = ShareOf(all, 2);
  EXPECT_EQ(share.bytes_max, 500U);
  EXPECT_EQ(share.records_max, 1U) << "never none";
  EXPECT_EQ(share.batch_records_max, all.batch_records_max);
}

TEST(ShardsTest, EachShardNumbersItsChangesOfPresence) {
  const storage::ProcessId process{1, 2, 3};
  EXPECT_EQ(PresenceSessionOf(process, 0), process);
  EXPECT_NE(PresenceSessionOf(process, 1), process);
  EXPECT_NE(PresenceSessionOf(process, 1), PresenceSessionOf(process, 2));
}

}  // namespace
}  // namespace uplink::journal
