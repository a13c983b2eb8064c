// When a stream is read, and what reads it again where it is held back.
#include "server/session/read_gate.h"

#include "tests/unit/server/session/stream_part_test.h"

namespace uplink::session {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class CountingSource final : public FrameSource {
 public:
  void RequestRead() override { ++requests; }

  int requests = 0;
};

class ReadGateTest : public StreamPartTest {
 protected:
  ReadGateTest() { EXPECT_TRUE(Attach(robot_, Terms(SessionOf(1))).ok()); }

  [[nodiscard]] bool held_back() { return robot_.robot().state.held_back(); }

  CountingSource source_;
  ReadGate gate_{{.context = context_, .robot = robot_, .source = source_, .timers = timers_}};
};

TEST_F(ReadGateTest, ARequestIsUnderWayUntilItsAnswer) {
  EXPECT_FALSE(gate_.under_way());
  gate_.Request();
  EXPECT_TRUE(gate_.under_way());
  EXPECT_EQ(source_.requests, 1);
  gate_.OnAnswer();
  EXPECT_FALSE(gate_.under_way());
}

TEST_F(ReadGateTest, AStreamThatNothingHoldsBackIsRead) {
  gate_.RequestUnless({.by = HeldBack::kNone});
  EXPECT_EQ(source_.requests, 1);
  EXPECT_TRUE(gate_.under_way());
  EXPECT_FALSE(held_back());
  EXPECT_EQ(probe_.held_back_total.value(), 0);
}

TEST_F(ReadGateTest, WhatHoldsAStreamBackIsNotReadAndSetsNoTimer) {
  for (const HeldBack by : {HeldBack::kInFlight, HeldBack::kUnread, HeldBack::kJournal}) {
    gate_.RequestUnless({.by = by});
    EXPECT_FALSE(gate_.under_way());
    EXPECT_FALSE(timers_.Next().has_value());
  }
  EXPECT_EQ(source_.requests, 0);
}

TEST_F(ReadGateTest, AThrottledStreamIsReadAgainAtTheEndOfItsThrottle) {
  const SteadyTime end = clock_.Steady() + milliseconds(400);
  gate_.RequestUnless({.by = HeldBack::kMalformed, .until = end});
  EXPECT_EQ(source_.requests, 0);
  EXPECT_EQ(timers_.at(Timer::kReadAgain), end);
  gate_.RequestUnless({.by = HeldBack::kNone});
  EXPECT_EQ(source_.requests, 1);
  EXPECT_FALSE(timers_.is_set(Timer::kReadAgain));
}

TEST_F(ReadGateTest, AThrottleThatEndedMeanwhileSetsNoTimer) {
  timers_.Set(Timer::kReadAgain, clock_.Steady());
  gate_.RequestUnless({.by = HeldBack::kMalformed});
  EXPECT_FALSE(timers_.is_set(Timer::kReadAgain));
}

TEST_F(ReadGateTest, AStreamThatTheJournalHoldsBackIsWokenOnceThereIsRoom) {
  gate_.RequestUnless({.by = HeldBack::kJournal});
  server_.Commit();
  EXPECT_THAT(woken_.streams, ElementsAre(1));
}

TEST_F(ReadGateTest, AStreamThatIsHeldBackForAnotherReasonIsNotWokenByTheJournal) {
  gate_.RequestUnless({.by = HeldBack::kInFlight});
  gate_.RequestUnless({.by = HeldBack::kUnread});
  server_.Commit();
  EXPECT_THAT(woken_.streams, IsEmpty());
}

TEST_F(ReadGateTest, HoldingBackIsCountedOncePerChange) {
  gate_.RequestUnless({.by = HeldBack::kInFlight});
  gate_.RequestUnless({.by = HeldBack::kUnread});
  EXPECT_EQ(probe_.held_back.value(), 1);
  EXPECT_EQ(probe_.held_back_total.value(), 1);
  EXPECT_EQ(probe_.held_back_by[static_cast<std::size_t>(HeldBack::kInFlight)].value(), 0);
  EXPECT_EQ(probe_.held_back_by[static_cast<std::size_t>(HeldBack::kUnread)].value(), 1);
  gate_.RequestUnless({.by = HeldBack::kNone});
  EXPECT_EQ(probe_.held_back_by[static_cast<std::size_t>(HeldBack::kUnread)].value(), 0);
  EXPECT_EQ(probe_.held_back.value(), 0);
  EXPECT_EQ(probe_.held_back_total.value(), 1);
  gate_.SetReading(ReadGate::Reading::kHeldBack);
  gate_.SetReading(ReadGate::Reading::kHeldBack);
  EXPECT_EQ(probe_.held_back.value(), 1);
  EXPECT_EQ(probe_.held_back_total.value(), 2);
}

TEST_F(ReadGateTest, TheRobotsSilenceIsOursWhileItIsHeldBack) {
  gate_.SetReading(ReadGate::Reading::kHeldBack);
  EXPECT_TRUE(held_back());
  gate_.SetReading(ReadGate::Reading::kFlowing);
  EXPECT_FALSE(held_back());
}

TEST_F(ReadGateTest, TheRobotShowsWhatHoldsItsStreamBack) {
  const auto shown = [this] { return robot_.robot().sessions.View().held_back; };
  for (const HeldBack by : {HeldBack::kInFlight, HeldBack::kJournal, HeldBack::kUnread,
                            HeldBack::kMalformed, HeldBack::kNone, HeldBack::kInFlight}) {
    gate_.RequestUnless({.by = by});
    EXPECT_EQ(shown(), by);
  }
  gate_.SetReading(ReadGate::Reading::kFlowing);
  EXPECT_EQ(shown(), HeldBack::kNone) << "the stream ends";
  gate_.SetReading(ReadGate::Reading::kHeldBack);
  EXPECT_EQ(shown(), HeldBack::kNone) << "the server wants no more of it";
}

TEST_F(ReadGateTest, ThePeersTimeRunsFromTheBoundOfItsFrames) {
  gate_.WatchPeer(kOutgoingFramesMax - 1);
  EXPECT_FALSE(timers_.is_set(Timer::kStall));
  const SteadyTime end = clock_.Steady() + kPeerStallMax;
  gate_.WatchPeer(kOutgoingFramesMax);
  EXPECT_EQ(timers_.at(Timer::kStall), end);
  clock_.Advance(milliseconds(1));
  gate_.WatchPeer(kOutgoingFramesMax + 1);
  EXPECT_EQ(timers_.at(Timer::kStall), end) << "it does not begin again";
  gate_.WatchPeer(kOutgoingFramesMax - 1);
  EXPECT_FALSE(timers_.is_set(Timer::kStall));
}

}  // namespace
}  // namespace uplink::session
