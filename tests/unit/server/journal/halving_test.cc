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
    for (int i = 0; i < times; ++i) EXPECT_EQ(journal.turns().Advance(), Step::kFailed);
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
  EXPECT_EQ(journal.turns().Advance(), Step::kWorked);
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
  EXPECT_THAT(client.Told(), ElementsAre("settled 1 2", "gaps 1", "settled 3 4", "settled 7"))
      << "what an earlier try of ours wrote was stored, also after the batch was halved";
  EXPECT_TRUE(journal.idle());
}

TEST_F(JournalHalving, GoesOnToASingleRecordAndGrowsAfterManySuccesses) {
  RecordingClient client("rcan://a");
  Open(client);
  Run();
  for (model::Seq seq = 1; seq <= 4; ++seq) Append(client, seq);
  store.FailNextCommits(3 * kFailuresToHalve, FailAt::kBefore);
  Fail(3 * kFailuresToHalve);
  auto before = store.commits();
  Run();
  EXPECT_EQ(store.commits() - before, 4U) << "one by one";
  for (model::Seq seq = 5; seq <= 4 + kSuccessesToDouble + 1; ++seq) Append(client, seq);
  before = store.commits();
  Run();
  // Twelve one by one make sixteen; then two by two.
  EXPECT_EQ(store.commits() - before, 15U);
  EXPECT_THAT(Stored(client), SizeIs(4 + kSuccessesToDouble + 1));
}

TEST_F(JournalHalving, ChangesOfPresenceAreHalvedInOrder) {
  std::deque<RecordingClient> robots;
  for (const char* ruri : {"rcan://a", "rcan://b", "rcan://c", "rcan://d", "rcan://e"}) {
    Open(robots.emplace_back(ruri));
  }
  Run();
  for (const RecordingClient& robot : robots) {
    journal.NotePresence(robot.robot(), model::Presence::kOnline, clock.System());
  }
  store.FailNextCommits(2 * kFailuresToHalve, FailAt::kAfter);
  Fail(2 * kFailuresToHalve);
  journal.NotePresence(robots[0].robot(), model::Presence::kOffline, clock.System());
  Run();
  EXPECT_TRUE(journal.idle());
  EXPECT_THAT(store.PresenceChanges({})->rows, SizeIs(6)) << "each once";
  EXPECT_EQ(probe.presence_changes[1].value(), 5);
  EXPECT_EQ(probe.presence_changes[2].value(), 1);
}

TEST_F(JournalHalving, GapsAreHalved) {
  RecordingClient client("rcan://a");
  Open(client);
  Run();
  for (model::Seq seq = 1; seq <= 4; ++seq) AppendGap(client, 10 * seq, 10 * seq + 5);
  store.FailNextCommits(kFailuresToHalve, FailAt::kBefore);
  Fail(kFailuresToHalve);
  EXPECT_EQ(journal.turns().Advance(), Step::kWorked);
  EXPECT_THAT(store.Gaps({})->rows, SizeIs(2));
  Run();
  EXPECT_THAT(store.Gaps({})->rows, SizeIs(4));
  EXPECT_TRUE(journal.idle());
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
  EXPECT_EQ(journal.turns().Advance(), Step::kWorked);
  EXPECT_THAT(clients[1].Told(), ElementsAre("opened 7"));
  EXPECT_THAT(clients[2].Told(), SizeIs(0));
  Run();
  EXPECT_THAT(clients[2].Told(), ElementsAre("opened 7"));
  EXPECT_THAT(clients[3].Told(), ElementsAre("opened 8"));
  EXPECT_TRUE(journal.idle());
}

}  // namespace
}  // namespace uplink::journal
