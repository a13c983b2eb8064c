#include <deque>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/journal/journal_bench.h"

/// A call that the store cannot do in its time becomes smaller.
namespace uplink::journal {
namespace {

using ::testing::ElementsAre;
using testing::FailAt;
using ::testing::SizeIs;

class JournalHalving : public ::testing::Test, protected JournalBench {
 protected:
  using JournalBench::Run;

  void Fail(int times) {
    for (int i = 0; i < times; ++i) EXPECT_EQ(journal.Advance(), Journal::Step::kFailed);
  }
};

TEST_F(JournalHalving, OfABatchTheLaterHalfWaits) {
  RecordingClient client("rcan://a");
  Open(client);
  Run();
  for (model::Seq seq = 1; seq <= 8; ++seq) Append(client, seq);
  store.FailNextCommits(kFailuresToHalve, FailAt::kBefore);
  Fail(kFailuresToHalve);
  EXPECT_EQ(journal.records(), 8U);
  EXPECT_EQ(journal.Advance(), Journal::Step::kWorked);
  EXPECT_THAT(Stored(client), ElementsAre(1U, 2U, 3U, 4U));
  Run();
  EXPECT_THAT(Stored(client), SizeIs(8));
  EXPECT_TRUE(journal.idle());
}

TEST_F(JournalHalving, ABatchThatWasWrittenAllTheSameIsNotDoubled) {
  RecordingClient client("rcan://a");
  Open(client);
  Run();
  static_cast<void>(client.Told());
  for (model::Seq seq = 1; seq <= 4; ++seq) Append(client, seq);
  AppendGap(client, 5, 6);
  store.FailNextCommits(kFailuresToHalve, FailAt::kAfter);
  Fail(kFailuresToHalve);
  Append(client, 7);
  Run();
  EXPECT_THAT(Stored(client), ElementsAre(1U, 2U, 3U, 4U, 7U));
  EXPECT_THAT(client.Told(),
              ElementsAre("settled 1 again 2 again", "gaps 1", "settled 3 again 4 again 7"));
  EXPECT_TRUE(journal.idle());
}

TEST_F(JournalHalving, GoesOnToASingleRecordAndGrowsAgain) {
  RecordingClient client("rcan://a");
  Open(client);
  Run();
  for (model::Seq seq = 1; seq <= 8; ++seq) Append(client, seq);
  store.FailNextCommits(5 * kFailuresToHalve, FailAt::kBefore);
  Fail(5 * kFailuresToHalve);
  const auto before = store.commits();
  Run();
  EXPECT_EQ(store.commits() - before, 4U) << "1, then 2, then 4, then the last";
  EXPECT_THAT(Stored(client), SizeIs(8));
}

TEST_F(JournalHalving, OfOpensTheLaterHalfWaits) {
  std::deque<RecordingClient> clients;
  for (int i = 0; i < 4; ++i) {
    Open(clients.emplace_back("rcan://" + std::to_string(i)), 7);
  }
  store.FailNextOpens(kFailuresToHalve, FailAt::kBefore);
  Fail(kFailuresToHalve);
  // A newer stream of one that waits stands for it.
  Open(clients[3], 8);
  EXPECT_EQ(journal.Advance(), Journal::Step::kWorked);
  EXPECT_THAT(clients[1].Told(), ElementsAre("opened 7"));
  EXPECT_THAT(clients[2].Told(), SizeIs(0));
  Run();
  EXPECT_THAT(clients[2].Told(), ElementsAre("opened 7"));
  EXPECT_THAT(clients[3].Told(), ElementsAre("opened 8"));
  EXPECT_TRUE(journal.idle());
}

}  // namespace
}  // namespace uplink::journal
