// A robot as one stream holds it: admitted, contested, opened, resumed, left.
#include "server/session/attachment.h"

#include "tests/unit/server/session/stream_part_test.h"

namespace uplink::session {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class AttachmentTest : public StreamPartTest {
 protected:
  Attachment other_{context_, Stream(2)};
};

TEST_F(AttachmentTest, TheFirstStreamIsTheRobots) {
  EXPECT_FALSE(robot_.attached());
  const auto standing = Attach(robot_, Terms(SessionOf(1)));
  ASSERT_TRUE(standing.ok());
  EXPECT_EQ(*standing, robot::Standing::kCurrent);
  EXPECT_TRUE(robot_.attached());
  EXPECT_EQ(&robot_.robot(), &server_.robot());
  EXPECT_EQ(robot_.session(), SessionOf(1));
  EXPECT_EQ(robot_.self(), Stream(1));
  EXPECT_THAT(woken_.streams, IsEmpty());
  EXPECT_EQ(probe_.takeovers_total.value(), 0);
}

TEST_F(AttachmentTest, ALaterStreamWaitsAndTheOneThatItReplacesIsWoken) {
  ASSERT_TRUE(Attach(robot_, Terms(SessionOf(1))).ok());
  const auto standing = Attach(other_, Terms(SessionOf(2)));
  ASSERT_TRUE(standing.ok());
  EXPECT_EQ(*standing, robot::Standing::kWaiting);
  EXPECT_EQ(robot_.standing(), robot::Standing::kSuperseded);
  EXPECT_THAT(woken_.streams, ElementsAre(1));
  EXPECT_EQ(probe_.takeovers_total.value(), 1);
}

TEST_F(AttachmentTest, WithItsLastStreamTheRobotIsClaimedNoMore) {
  const storage::StoredPresence stored{model::Presence::kOffline, SystemTime()};
  ASSERT_TRUE(Attach(robot_, Terms(SessionOf(1))).ok());
  robot_.robot().state.Claim({});
  robot_.robot().state.FollowHolder({.held_by = "b:2"}, stored);
  const auto shown = [this] {
    return server_.robot().state.Snapshot(robot::RobotState::Parts::kNone).foreign;
  };
  EXPECT_FALSE(shown()) << "a stream of it is here";
  robot_.Detach();
  server_.robot().state.FollowHolder({.held_by = "b:2"}, stored);
  EXPECT_TRUE(shown());
}

TEST_F(AttachmentTest, AStreamThatLeavesWakesTheOneThatWaits) {
  ASSERT_TRUE(Attach(robot_, Terms(SessionOf(1))).ok());
  ASSERT_TRUE(Attach(other_, Terms(SessionOf(2))).ok());
  woken_.streams.clear();
  robot_.Detach();
  EXPECT_THAT(woken_.streams, ElementsAre(2));
  EXPECT_EQ(other_.standing(), robot::Standing::kCurrent);
  other_.Detach();
  EXPECT_THAT(woken_.streams, ElementsAre(2)) << "no stream waits";
}

TEST_F(AttachmentTest, ARobotThatChangesHandsTooOftenIsContestedOnce) {
  ASSERT_TRUE(Attach(robot_, Terms(SessionOf(1))).ok());
  for (std::uint32_t i = 0; i < robot::kTakeoversPerMinuteMax; ++i) {
    ASSERT_TRUE(Attach(other_, Terms(SessionOf(2))).ok());
  }
  EXPECT_EQ(probe_.contested_total.value(), 0);
  ASSERT_TRUE(Attach(other_, Terms(SessionOf(2))).ok());
  ASSERT_TRUE(Attach(other_, Terms(SessionOf(2))).ok());
  EXPECT_EQ(probe_.contested_total.value(), 1);
  EXPECT_EQ(probe_.takeovers_total.value(), robot::kTakeoversPerMinuteMax + 2);
}

TEST_F(AttachmentTest, ARobotPastTheBoundIsRefusedAndCounted) {
  fleet::Fleet fleet(clock_, 1, {});
  const SessionContext full{.clock = clock_,
                            .fleet = fleet,
                            .journals = shards_,
                            .probe = probe_,
                            .ledger = ledger_,
                            .judge = judge_,
                            .limits = limits_.session,
                            .scratch = scratch_,
                            .allowances = allowances_,
                            .rejects = rejects_,
                            .clock_trust = clock_trust_};
  Attachment last(full, Stream(1));
  ASSERT_TRUE(Attach(last, Terms(SessionOf(1))).ok());
  EXPECT_EQ(probe_.refused_full_total.value(), 0);
  Attachment past(full, Stream(2));
  const auto standing = Attach(past, {.claim = {.robot = {.ruri = "rcan://bench/2"}}});
  EXPECT_TRUE(absl::IsResourceExhausted(standing.status())) << standing.status();
  EXPECT_FALSE(past.attached());
  EXPECT_EQ(probe_.refused_full_total.value(), 1);
  EXPECT_EQ(fleet.size(), 1U);
}

TEST_F(AttachmentTest, TheSessionIsOpenOnceTheStoreHasAnswered) {
  ASSERT_TRUE(Attach(robot_, Terms(SessionOf(1))).ok());
  const auto by = robot_.Open(clock_.Steady());
  ASSERT_TRUE(by.ok());
  EXPECT_EQ(by->generation, robot_.robot().sessions.generation());
  EXPECT_FALSE(robot_.opened());
  server_.Commit();
  EXPECT_TRUE(robot_.opened());
  EXPECT_THAT(woken_.streams, ElementsAre(1));
}

TEST_F(AttachmentTest, AnAnswerToAnEarlierStreamOpensNothing) {
  ASSERT_TRUE(Attach(robot_, Terms(SessionOf(1))).ok());
  ASSERT_TRUE(robot_.Open(clock_.Steady()).ok());
  ASSERT_TRUE(Attach(other_, Terms(SessionOf(1))).ok());
  robot_.Detach();
  ASSERT_TRUE(other_.Open(clock_.Steady()).ok());
  server_.Commit();
  EXPECT_FALSE(robot_.opened());
  EXPECT_TRUE(other_.opened());
}

TEST_F(AttachmentTest, ASessionMoreThanFitIsRefusedWhereAllWaitForTheStore) {
  ASSERT_TRUE(Attach(robot_, Terms(SessionOf(1))).ok());
  robot::RobotSessions& sessions = robot_.robot().sessions;
  for (std::uint8_t number = 2; number <= robot::kSessionsMax; ++number) {
    ASSERT_TRUE(sessions.Begin(SessionOf(number), clock_.Steady()).has_value());
    ASSERT_EQ(sessions.AddWaiting(SessionOf(number), 1), 1);
  }
  ASSERT_TRUE(robot_.Open(clock_.Steady()).ok()) << "the last that fits";
  ASSERT_EQ(sessions.AddWaiting(SessionOf(1), 1), 1);
  EXPECT_EQ(robot_.waiting(), 1U);
  ASSERT_TRUE(Attach(other_, Terms(SessionOf(9))).ok());
  const auto past = other_.Open(clock_.Steady());
  EXPECT_TRUE(absl::IsResourceExhausted(past.status())) << past.status();
  EXPECT_EQ(sessions.Held().size(), robot::kSessionsMax);
}

TEST_F(AttachmentTest, AResumeSaysWhatTheAgentSawSettledAndIsCountedIfItSawAny) {
  ASSERT_TRUE(Attach(robot_, Terms(SessionOf(1))).ok());
  ASSERT_TRUE(robot_.Open(clock_.Steady()).ok());
  EXPECT_EQ(robot_.Resume().committed, 0U);
  EXPECT_EQ(probe_.resumes_total.value(), 0);
  HelloTerms terms = Terms(SessionOf(2));
  terms.settled_seq = 7;
  terms.judged_seq = 9;
  ASSERT_TRUE(Attach(other_, terms).ok());
  robot_.Detach();
  ASSERT_TRUE(other_.Open(clock_.Steady()).ok());
  EXPECT_EQ(other_.Resume().committed, 7U);
  EXPECT_EQ(probe_.resumes_total.value(), 1);
  EXPECT_EQ(other_.TakeProgress().judged, 9U);
}

TEST_F(AttachmentTest, ANewStreamCountsDroppedFieldsFromZero) {
  ASSERT_TRUE(Attach(robot_, Terms(SessionOf(1))).ok());
  ASSERT_TRUE(robot_.Open(clock_.Steady()).ok());
  robot_.robot().state.CountDropped(3);
  static_cast<void>(robot_.Resume());
  EXPECT_EQ(robot_.robot().state.Snapshot(robot::RobotState::Parts::kNone).fields_dropped, 0);
}

TEST_F(AttachmentTest, ProgressIsOfTheStreamsOwnSession) {
  ASSERT_TRUE(Attach(robot_, Terms(SessionOf(1))).ok());
  ASSERT_TRUE(robot_.Open(clock_.Steady()).ok());
  robot::RobotSessions& sessions = robot_.robot().sessions;
  sessions.AddSettled(SessionOf(1), 3);
  ASSERT_EQ(sessions.AddWaiting(SessionOf(1), 4), 1);
  const robot::Progress progress = robot_.TakeProgress();
  EXPECT_EQ(progress.through, 3U);
  EXPECT_EQ(progress.judged, 4U);
  EXPECT_EQ(robot_.waiting(), 1U);
  EXPECT_EQ(sessions.waiting(SessionOf(2)), 0U);
}

}  // namespace
}  // namespace uplink::session
