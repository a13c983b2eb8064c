#include "server/journal/comparing.h"

#include <deque>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/journal/committing.h"
#include "server/journal/opening.h"
#include "tests/unit/server/journal/step_bench.h"

namespace uplink::journal {
namespace {

using ::testing::ElementsAre;
using testing::FailAt;
using ::testing::IsEmpty;

class ComparingTest : public ::testing::Test, protected StepBench {
 protected:
  ComparingTest() {
    Hold(robot_);
    Hold(other_);
  }
  static std::vector<storage::CommittedSession> Through(model::Seq cursor) {
    return {{.session = model::SessionId(), .cursor = cursor}};
  }
  void Compare() { ASSERT_FALSE(comparing_.Do().has_value()); }

  CountingInbox wakes_;
  RecordingClient robot_{"rcan://a", {.inbox = &wakes_, .stream = 1}};
  RecordingClient other_{"rcan://b", {.inbox = &wakes_, .stream = 2}};
  Comparing comparing_{context(), holds};
  Committing committing_{
      context(), holds, {.records_max = 8, .bytes_max = 1'000'000}, model::SessionId()};
};

TEST_F(ComparingTest, IsDueOnceTheConnectionBroke) {
  EXPECT_FALSE(comparing_.Due());
  store.Break();
  EXPECT_TRUE(comparing_.Due());
  EXPECT_FALSE(store.Commit({}).ok()) << "nothing else is asked of it before";
  Compare();
  EXPECT_FALSE(comparing_.Due());
  EXPECT_TRUE(store.Commit({}).ok());
  EXPECT_THAT(reconnects, ElementsAre(Reconnected::kSameServer));
}

TEST_F(ComparingTest, TellsWhetherTheServerIsTheOneThatToldWhatIsCompared) {
  EXPECT_FALSE(comparing_.Due());
  store.Break();
  Compare();
  testing::FakeDatabase standby;
  standby.CopyRowsOf(database);
  database.CopyRowsOf(standby);
  store.Break();
  store.FailNext(1, FailAt::kAfter);
  EXPECT_EQ(comparing_.Do(), Step::kFailed) << "and tells nothing of that one";
  Compare();
  store.Break();
  Compare();
  EXPECT_THAT(reconnects, ElementsAre(Reconnected::kSameServer, Reconnected::kMayHaveGoneBack,
                                      Reconnected::kSameServer));
}

TEST_F(ComparingTest, WhatIsAsItWasToldGoesOn) {
  robot_.SetCommitted(Through(4));
  Append(robot_, 4);
  ASSERT_TRUE(committing_.Gather());
  ASSERT_EQ(committing_.Commit(), Step::kWorked);
  committing_.Tell();
  static_cast<void>(robot_.Told());
  store.Break();
  Compare();
  EXPECT_THAT(robot_.Told(), IsEmpty());
  EXPECT_THAT(other_.Told(), IsEmpty());
  EXPECT_EQ(probe.went_back.value(), 0);
  EXPECT_EQ(probe.went_back_at.load(), SteadyTime());
}

TEST_F(ComparingTest, ARobotOfWhichTheStoreHasLessIsVoidAndHeldStill) {
  robot_.SetCommitted(Through(4));
  const storage::Epoch since = holds.robots().Since(robot_);
  store.Break();
  Compare();
  EXPECT_THAT(robot_.Told(), ElementsAre("went back"));
  EXPECT_EQ(wakes_.wakes(1), 1);
  EXPECT_THAT(other_.Told(), IsEmpty());
  EXPECT_EQ(holds.robots().Since(robot_), since);
  EXPECT_EQ(probe.went_back.value(), 1);
  EXPECT_EQ(probe.went_back_at.load(), clock.Steady());
  EXPECT_THAT(went_back.Take().named, ElementsAre("rcan://a"));
  EXPECT_EQ(went_back.Take().robots, 0U) << "once";
}

TEST_F(ComparingTest, OfManyRobotsOfWhichTheStoreHasLessTheFirstAreNamed) {
  std::deque<RecordingClient> many;
  for (std::size_t i = 0; i <= kWentBackNamed; ++i) {
    Hold(many.emplace_back("rcan://many/" + std::to_string(i)));
    many.back().SetCommitted(Through(4));
  }
  store.Break();
  Compare();
  const WentBack found = went_back.Take();
  EXPECT_EQ(found.robots, kWentBackNamed + 1);
  EXPECT_EQ(found.named.size(), kWentBackNamed);
  EXPECT_EQ(found.named.front(), "rcan://many/0");
}

TEST_F(ComparingTest, WhatWaitsOfItIsNotWrittenAndTheRestIs) {
  robot_.SetCommitted(Through(4));
  Append(robot_, 6);
  Append(other_, 1);
  // The answer to this commit is lost with the primary.
  ASSERT_TRUE(committing_.Gather());
  store.FailNextCommits(1, FailAt::kBefore);
  ASSERT_EQ(committing_.Commit(), Step::kFailed);
  store.Break();
  committing_.PutBack();
  Compare();
  ASSERT_TRUE(committing_.Gather());
  ASSERT_EQ(committing_.Commit(), Step::kWorked);
  committing_.Tell();
  EXPECT_THAT(Stored(robot_), IsEmpty()) << "the cursor would pass what the robot sends again";
  EXPECT_THAT(Stored(other_), ElementsAre(1));
  EXPECT_TRUE(inbox.idle());
}

TEST_F(ComparingTest, AHoldThatTheStoreDoesNotHaveIsLost) {
  storage::OpenRequest request{.robot = robot_.robot()};
  testing::FakeStore another(database, storage::ProcessId{2});
  ASSERT_TRUE(another.OpenStreams({&request, 1}).ok());
  store.Break();
  Compare();
  EXPECT_THAT(robot_.Told(), ElementsAre("fenced"));
  EXPECT_EQ(holds.robots().Since(robot_), 0U);
  EXPECT_EQ(probe.went_back.value(), 0) << "it went to another process meanwhile";
}

TEST_F(ComparingTest, AChangeOfPresenceThatWasLostIsWrittenAgain) {
  inbox.NotePresence(robot_.robot(), model::Presence::kOnline, clock.System());
  // It was committed on a primary that is gone.
  static_cast<void>(
      writer_inbox.Fill(GatheredBatch(model::SessionId()), {.records_max = 8}, holds.robots()));
  writer_inbox.CountPresenceCommitted(1);
  store.Break();
  Compare();
  EXPECT_EQ(probe.went_back.value(), 1);
  EXPECT_THAT(robot_.Told(), IsEmpty());
  const GatheredBatch batch =
      writer_inbox.Fill(GatheredBatch(model::SessionId()), {.records_max = 8}, holds.robots());
  ASSERT_EQ(batch.batch().presence.size(), 1U);
  EXPECT_EQ(batch.batch().presence.front().presence, model::Presence::kOnline);
}

TEST_F(ComparingTest, AStoreThatIsAwayIsAskedAgain) {
  robot_.SetCommitted(Through(4));
  store.Break();
  store.FailNext(1, FailAt::kBefore);
  EXPECT_EQ(comparing_.Do(), Step::kFailed);
  EXPECT_TRUE(comparing_.Due());
  EXPECT_FALSE(errors.last().ok());
  EXPECT_THAT(reconnects, IsEmpty());
  Compare();
  EXPECT_THAT(robot_.Told(), ElementsAre("went back"));
}

// What was compared before may be with a store that is gone.
TEST_F(ComparingTest, AConnectionThatBreaksBetweenTwoPagesBeginsTheComparisonAnew) {
  std::deque<RecordingClient> many;
  for (std::size_t i = 0; i < 2 * storage::kComparedMax; ++i) {
    Hold(many.emplace_back("rcan://many/" + std::to_string(i)));
  }
  store.Break();
  store.BreakAtCompare(3);
  EXPECT_EQ(comparing_.Do(), Step::kFailed);
  EXPECT_THAT(robot_.Told(), IsEmpty());
  EXPECT_TRUE(comparing_.Due());
  EXPECT_THAT(reconnects, IsEmpty());
  // The next store has less of all of them, whichever page they were on.
  robot_.SetCommitted(Through(4));
  many.front().SetCommitted(Through(4));
  many.back().SetCommitted(Through(4));
  Compare();
  EXPECT_THAT(robot_.Told(), ElementsAre("went back"));
  EXPECT_THAT(many.front().Told(), ElementsAre("went back"));
  EXPECT_THAT(many.back().Told(), ElementsAre("went back"));
  EXPECT_EQ(probe.went_back.value(), 3);
}

TEST_F(ComparingTest, ACursorBelowWhatWasToldIsFoundWhenAStreamOpensToo) {
  robot_.SetCommitted(Through(4));
  Opening opening(context(), holds);
  Open(robot_, 7);
  ASSERT_TRUE(opening.Gather().opens);
  ASSERT_EQ(opening.Open(), Step::kWorked);
  EXPECT_THAT(robot_.Told(), ElementsAre("went back"));
  EXPECT_EQ(probe.went_back.value(), 1);
}

}  // namespace
}  // namespace uplink::journal
