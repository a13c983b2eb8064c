// How a stream's numbers become seen, settled and waiting in the robot's sessions.
#include "server/session/number_run.h"

#include <gtest/gtest.h>

#include "tests/support/manual_clock.h"

namespace uplink::session {
namespace {

class SilentInbox final : public loop::WakeInbox {
 public:
  void Wake(std::uint64_t /*stream*/) override {}
};

class NumberRunTest : public ::testing::Test {
 protected:
  NumberRunTest() {
    static_cast<void>(
        sessions_.Attach({.inbox = &inbox_, .stream = 1}, clock_.Steady(), clock_.System()));
    EXPECT_TRUE(sessions_.Begin(session_, clock_.Steady()).has_value());
    run_.Begin();
  }
  /// As a stream of its own would see it, behind the run's back.
  robot::SeenAs SeenBySessions(model::Seq seq) { return sessions_.See(session_, seq).as; }
  void AddLive(model::Seq seq) {
    EXPECT_EQ(run_.See(seq).as, robot::SeenAs::kNew);
    run_.AddSettled(seq);
  }

  testing::ManualClock clock_;
  SilentInbox inbox_;
  metrics::Ledger ledger_;
  robot::RobotSessions sessions_;
  const model::SessionId session_{{1}};
  NumberRun run_{sessions_, session_};
};

TEST_F(NumberRunTest, TheSessionsLearnOfARunOfSettledNumbersAtItsEnd) {
  AddLive(1);
  AddLive(2);
  AddLive(3);
  run_.Flush();
  EXPECT_EQ(SeenBySessions(3), robot::SeenAs::kDuplicate);
  run_.Begin();
  EXPECT_EQ(run_.See(2).as, robot::SeenAs::kDuplicate);
  EXPECT_EQ(run_.See(4).as, robot::SeenAs::kNew);
}

TEST_F(NumberRunTest, ALookTellsWhatWasSettledBeforeIt) {
  AddLive(1);
  AddLive(2);
  const robot::Seen seen = run_.See(5);
  EXPECT_EQ(seen.as, robot::SeenAs::kNew);
  EXPECT_EQ(seen.missing_first, 3U);
  EXPECT_EQ(seen.missing_last, 4U);
}

TEST_F(NumberRunTest, ANumberThatWaitsComesAfterThoseThatAreSettled) {
  AddLive(1);
  EXPECT_EQ(run_.See(2).as, robot::SeenAs::kNew);
  EXPECT_EQ(run_.AddWaiting(2, 100), 1);
  EXPECT_EQ(sessions_.waiting(session_), 1U);
  AddLive(3);
  run_.Flush();
  EXPECT_TRUE(run_.See(2).waits);
}

TEST_F(NumberRunTest, OnceAnotherProcessHasTheRobotTheNextLookSaysSo) {
  AddLive(1);
  EXPECT_EQ(run_.See(2).as, robot::SeenAs::kNew);
  sessions_.OnFenced(ledger_);
  EXPECT_EQ(run_.AddWaiting(2, 100), 0);
  EXPECT_EQ(run_.See(3).as, robot::SeenAs::kVoid);
}

TEST_F(NumberRunTest, APassBeginsWithALook) {
  AddLive(1);
  run_.Flush();
  sessions_.OnFenced(ledger_);
  run_.Begin();
  EXPECT_EQ(run_.See(2).as, robot::SeenAs::kVoid);
}

}  // namespace
}  // namespace uplink::session
