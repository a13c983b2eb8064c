#include "server/robot/presence_track.h"

#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/manual_clock.h"

namespace uplink::robot {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;
using ::testing::SizeIs;

class PresenceTrackTest : public ::testing::Test {
 protected:
  PresenceTrack::Sign Sign() { return track_.AddSign(clock_.Steady(), clock_.System(), limits_); }
  /// After a holder that ended, without a grace.
  void Adopt(const storage::StoredPresence& stored) {
    track_.Adopt({.stored = stored,
                  .unknown_until = clock_.Steady(),
                  .now = clock_.Steady(),
                  .system_now = clock_.System()});
  }
  Presence Sweep() { return track_.Sweep(clock_.Steady(), clock_.System(), limits_); }

  testing::ManualClock clock_;
  const PresenceLimits limits_{};
  std::vector<std::pair<Presence, SystemTime>> changes_;
  PresenceTrack track_{clock_.Steady(), clock_.Steady(), clock_.System(),
                       [this](const storage::StoredPresence& now) {
                         changes_.emplace_back(now.presence, now.since);
                       }};
};

TEST_F(PresenceTrackTest, ASignOfLifeMakesARobotOnlineAndIsToldOnce) {
  EXPECT_EQ(track_.presence(), Presence::kUnknown);
  EXPECT_EQ(Sign(), PresenceTrack::Sign::kLatest);
  EXPECT_EQ(Sign(), PresenceTrack::Sign::kLatest);
  EXPECT_EQ(track_.presence(), Presence::kOnline);
  EXPECT_THAT(changes_, ElementsAre(Pair(Presence::kOnline, clock_.System())));
}

TEST_F(PresenceTrackTest, AnOlderSignChangesNothing) {
  const SteadyTime before = clock_.Steady();
  const SystemTime before_system = clock_.System();
  clock_.Advance(std::chrono::seconds(1));
  Sign();
  EXPECT_EQ(track_.AddSign(before, before_system, limits_), PresenceTrack::Sign::kOlder);
  EXPECT_EQ(track_.last_sign(), clock_.System());
}

TEST_F(PresenceTrackTest, SilenceWhileHeldBackIsNotOffline) {
  Sign();
  track_.SetReading(PresenceTrack::Reading::kHeldBack, clock_.Steady());
  EXPECT_TRUE(track_.held_back());
  clock_.Advance(limits_.timeout + milliseconds(1));
  EXPECT_EQ(Sweep(), Presence::kUnknown);
  track_.SetReading(PresenceTrack::Reading::kFlowing, clock_.Steady());
  EXPECT_EQ(track_.stream_held_back_until(), clock_.Steady());
  clock_.Advance(limits_.timeout + milliseconds(1));
  EXPECT_EQ(Sweep(), Presence::kOffline);
}

TEST_F(PresenceTrackTest, AStallKeepsWhoWasOfflineOffline) {
  Sign();
  clock_.Advance(limits_.timeout + milliseconds(1));
  EXPECT_EQ(Sweep(), Presence::kOffline);
  track_.AddStall(clock_.Steady());
  EXPECT_EQ(Sweep(), Presence::kOffline);
}

TEST_F(PresenceTrackTest, AStallWhileARobotWasOfflineCountsOnceItIsHeard) {
  Sign();
  clock_.Advance(limits_.timeout + milliseconds(1));
  EXPECT_EQ(Sweep(), Presence::kOffline);
  constexpr std::chrono::minutes kStall{1};
  track_.AddStall(clock_.Steady() + kStall);
  track_.AddStall(clock_.Steady());
  // What it sent before the stall is read after it.
  Sign();
  clock_.Advance(limits_.timeout + milliseconds(1));
  EXPECT_EQ(Sweep(), Presence::kUnknown);
  clock_.Advance(kStall - milliseconds(1));
  EXPECT_EQ(Sweep(), Presence::kUnknown);
  clock_.Advance(milliseconds(1));
  EXPECT_EQ(Sweep(), Presence::kOffline);
}

TEST_F(PresenceTrackTest, WhatAnEarlierLifeHeardIsKeptUntilASignComes) {
  const SystemTime earlier = clock_.System() - std::chrono::hours(1);
  track_.Restore(earlier);
  EXPECT_EQ(track_.last_sign(), earlier);
  EXPECT_EQ(track_.presence(), Presence::kUnknown);
  Sign();
  track_.Restore(earlier);
  EXPECT_EQ(track_.last_sign(), clock_.System());
}

TEST_F(PresenceTrackTest, WhoComesByAStreamStaysAsTheOtherProcessWroteItUntilItsTime) {
  const SystemTime since = clock_.System() - std::chrono::hours(2);
  track_.Claim({Presence::kOnline, since}, clock_.Steady());
  EXPECT_EQ(track_.presence(), Presence::kOnline);
  EXPECT_EQ(track_.since(), since);
  clock_.Advance(limits_.timeout);
  EXPECT_EQ(Sweep(), Presence::kOnline);
  Sign();
  EXPECT_EQ(track_.since(), since) << "no change";
  EXPECT_THAT(changes_, IsEmpty());
}

TEST_F(PresenceTrackTest, WhoComesByAStreamAndSaysNothingIsOfflineInTheEnd) {
  clock_.Advance(limits_.startup_grace);
  track_.Claim({Presence::kOnline, clock_.System()}, clock_.Steady());
  clock_.Advance(limits_.timeout + milliseconds(1));
  EXPECT_EQ(Sweep(), Presence::kOffline);
}

TEST_F(PresenceTrackTest, WhoWasOfflineElsewhereIsSoUntilItIsHeard) {
  const SystemTime since = clock_.System() - std::chrono::hours(2);
  track_.Claim({Presence::kOffline, since}, clock_.Steady());
  EXPECT_EQ(Sweep(), Presence::kOffline) << "even within the grace of a start";
  EXPECT_EQ(track_.since(), since);
  EXPECT_THAT(changes_, IsEmpty());
  Sign();
  EXPECT_EQ(track_.presence(), Presence::kOnline);
}

TEST_F(PresenceTrackTest, WhatWasHeardHereStandsAgainstWhatAnotherWrote) {
  Sign();
  const SystemTime since = clock_.System() - std::chrono::hours(2);
  track_.Claim({Presence::kOffline, since}, clock_.Steady());
  EXPECT_EQ(track_.presence(), Presence::kOnline);
  EXPECT_NE(track_.since(), since);
  track_.Claim({Presence::kOnline, since}, clock_.Steady());
  EXPECT_EQ(track_.since(), since) << "it was online all the time";
}

TEST_F(PresenceTrackTest, WhoWasOnlineElsewhereUntilItWasTakenHasATimeoutFromThenOn) {
  const SystemTime since = clock_.System();
  Sign();
  clock_.Advance(limits_.timeout - milliseconds(1));
  track_.Claim({Presence::kOnline, since}, clock_.Steady());
  clock_.Advance(limits_.timeout);
  EXPECT_EQ(Sweep(), Presence::kOnline) << "the other process heard it since";
  clock_.Advance(milliseconds(1));
  EXPECT_EQ(Sweep(), Presence::kOffline);
  EXPECT_THAT(changes_, SizeIs(2));
}

TEST_F(PresenceTrackTest, WhatWasHeardHereInTimeStandsThoughAnotherHadTheRobotMeanwhile) {
  Sign();
  changes_.clear();
  const SystemTime since = clock_.System();
  track_.Follow({Presence::kOffline, since});
  clock_.Advance(milliseconds(1));
  track_.Claim({Presence::kOffline, since}, clock_.Steady());
  EXPECT_THAT(changes_, ElementsAre(Pair(Presence::kOnline, since)));
  clock_.Advance(limits_.timeout - milliseconds(1));
  EXPECT_EQ(Sweep(), Presence::kOnline);
  clock_.Advance(milliseconds(1));
  EXPECT_EQ(Sweep(), Presence::kOffline);
}

/// The store went back, and names this process again: another one may have heard the robot since.
TEST_F(PresenceTrackTest, AStallWhileAnotherHadTheRobotCountsOnceItIsOurs) {
  Sign();
  track_.Follow({Presence::kOnline, clock_.System()});
  clock_.Advance(limits_.timeout - milliseconds(1));
  track_.AddStall(clock_.Steady());
  Adopt({Presence::kUnknown, clock_.System()});
  clock_.Advance(limits_.timeout);
  EXPECT_EQ(Sweep(), Presence::kUnknown) << "a timeout to be heard";
  clock_.Advance(milliseconds(1));
  EXPECT_EQ(Sweep(), Presence::kOffline);
}

TEST_F(PresenceTrackTest, AStallFromBeforeAnAdoptionLeavesWhoWasOfflineOffline) {
  clock_.Advance(limits_.startup_grace);
  Sign();
  const SystemTime since = clock_.System();
  track_.AddStall(clock_.Steady() + limits_.startup_grace);
  track_.Follow({Presence::kOnline, since});
  track_.AddStall(clock_.Steady() + limits_.startup_grace);
  clock_.Advance(limits_.timeout + milliseconds(1));
  changes_.clear();
  Adopt({Presence::kOffline, since});
  EXPECT_EQ(Sweep(), Presence::kOffline);
  EXPECT_EQ(track_.since(), since);
  EXPECT_THAT(changes_, IsEmpty());
}

TEST_F(PresenceTrackTest, WhoWasHeardHereBeforeAnAdoptionHasATimeoutFromThenOn) {
  Sign();
  track_.Follow({Presence::kOnline, clock_.System()});
  clock_.Advance(limits_.timeout - milliseconds(1));
  Adopt({Presence::kOnline, clock_.System()});
  clock_.Advance(limits_.timeout);
  EXPECT_EQ(Sweep(), Presence::kOnline) << "the other process may have heard it just now";
  clock_.Advance(milliseconds(1));
  EXPECT_EQ(Sweep(), Presence::kOffline);
}

TEST_F(PresenceTrackTest, WhatWasToldInVainGivesWayToWhatAnotherWroteMeanwhile) {
  clock_.Advance(limits_.startup_grace);
  Sign();
  clock_.Advance(limits_.timeout + milliseconds(1));
  EXPECT_EQ(Sweep(), Presence::kOffline) << "heard here, before the store said whose it is";
  changes_.clear();
  const SystemTime since = clock_.System() - milliseconds(1);
  track_.Claim({Presence::kOnline, since}, clock_.Steady());
  EXPECT_EQ(track_.presence(), Presence::kOnline) << "it was elsewhere meanwhile";
  EXPECT_EQ(track_.since(), since);
  EXPECT_THAT(changes_, IsEmpty());
  clock_.Advance(limits_.timeout + milliseconds(1));
  EXPECT_EQ(Sweep(), Presence::kOffline);
}

TEST_F(PresenceTrackTest, WhatWasHeardInTimeIsToldAgainOnceTheStoreSaysWhoseItIs) {
  Sign();
  changes_.clear();
  clock_.Advance(limits_.timeout);
  track_.Claim({Presence::kUnknown, SystemTime()}, clock_.Steady());
  EXPECT_THAT(changes_, ElementsAre(Pair(Presence::kOnline, track_.since())));
}

TEST_F(PresenceTrackTest, AnAdoptedRobotThatWasHeardTooLongAgoIsUnknownForItsGrace) {
  clock_.Advance(limits_.startup_grace);
  Sign();
  clock_.Advance(limits_.timeout + milliseconds(1));
  EXPECT_EQ(Sweep(), Presence::kOffline);
  track_.Adopt({.stored = {Presence::kOnline, SystemTime()},
                .unknown_until = clock_.Steady() + std::chrono::hours(1),
                .now = clock_.Steady(),
                .system_now = clock_.System()});
  EXPECT_EQ(Sweep(), Presence::kUnknown);
}

TEST_F(PresenceTrackTest, WhatWasHeardWithoutAChangeIsToldWhereTheStoreHasAnotherByThen) {
  track_.Follow({Presence::kOnline, SystemTime()});
  track_.Claim({Presence::kOnline, SystemTime()}, clock_.Steady());
  Sign();
  EXPECT_THAT(changes_, IsEmpty());
  const SystemTime later = clock_.System() + std::chrono::hours(1);
  track_.Claim({Presence::kUnknown, later}, clock_.Steady());
  EXPECT_THAT(changes_, ElementsAre(Pair(Presence::kOnline, later)));
}

TEST_F(PresenceTrackTest, WhoIsDoubtedIsUnknownUntilItIsHeardOrTheTimeIsOver) {
  track_.ForgetSigns(clock_.Steady() + std::chrono::seconds(5), clock_.System());
  EXPECT_THAT(changes_, IsEmpty()) << "it was not online";
  Sign();
  changes_.clear();
  track_.ForgetSigns(clock_.Steady() + std::chrono::seconds(5), clock_.System());
  EXPECT_EQ(track_.presence(), Presence::kUnknown);
  EXPECT_EQ(changes_.size(), 1U);
  clock_.Advance(std::chrono::seconds(4));
  EXPECT_EQ(Sweep(), Presence::kUnknown);
  Sign();
  EXPECT_EQ(track_.presence(), Presence::kOnline) << "and that is told";
  EXPECT_EQ(changes_.size(), 2U);
  track_.ForgetSigns(clock_.Steady() + std::chrono::seconds(5), clock_.System());
  clock_.Advance(std::chrono::hours(1));
  EXPECT_EQ(Sweep(), Presence::kOffline);
}

TEST_F(PresenceTrackTest, AnAdoptedRobotIsUnknownForItsGrace) {
  clock_.Advance(std::chrono::hours(5));
  const SteadyTime until = clock_.Steady() + std::chrono::hours(1);
  track_.Adopt({.stored = {Presence::kOnline, SystemTime()},
                .unknown_until = until,
                .now = clock_.Steady(),
                .system_now = clock_.System()});
  EXPECT_EQ(track_.presence(), Presence::kUnknown);
  EXPECT_EQ(track_.since(), clock_.System());
  EXPECT_THAT(changes_, SizeIs(1));
  clock_.Advance(std::chrono::hours(1));
  EXPECT_EQ(Sweep(), Presence::kUnknown);
  clock_.Advance(milliseconds(1));
  EXPECT_EQ(Sweep(), Presence::kOffline);
}

TEST_F(PresenceTrackTest, AnAdoptedRobotThatWasUnknownIsSoSinceThen) {
  const SystemTime since = clock_.System() - std::chrono::hours(2);
  track_.Adopt({.stored = {Presence::kUnknown, since},
                .unknown_until = clock_.Steady(),
                .now = clock_.Steady(),
                .system_now = clock_.System()});
  EXPECT_EQ(track_.since(), since);
  EXPECT_THAT(changes_, IsEmpty());
}

TEST_F(PresenceTrackTest, AnAdoptedRobotThatWasOfflineStaysSoWithItsTimeUntilItIsHeard) {
  const SystemTime since = clock_.System() - std::chrono::hours(2);
  track_.Adopt({.stored = {Presence::kOffline, since},
                .unknown_until = clock_.Steady() + std::chrono::hours(1),
                .now = clock_.Steady(),
                .system_now = clock_.System()});
  EXPECT_EQ(Sweep(), Presence::kOffline);
  clock_.Advance(std::chrono::hours(3));
  EXPECT_EQ(Sweep(), Presence::kOffline);
  EXPECT_EQ(track_.since(), since);
  EXPECT_THAT(changes_, IsEmpty());
  Sign();
  EXPECT_THAT(changes_, ElementsAre(Pair(Presence::kOnline, clock_.System())));
}

/// Adopted from a holder that fell silent, and had called the robot offline.
class OfflineAtSilent : public PresenceTrackTest {
 protected:
  OfflineAtSilent() {
    track_.Adopt({.stored = {Presence::kOffline, since_},
                  .end = storage::HolderEnd::kSilent,
                  .unknown_until = clock_.Steady() + kGrace,
                  .now = clock_.Steady(),
                  .system_now = clock_.System()});
  }

  static constexpr std::chrono::hours kGrace{1};
  const SystemTime since_ = clock_.System() - std::chrono::hours(2);
};

TEST_F(OfflineAtSilent, IsUnknownSinceItMayBeHeardThereAndThenOfflineAsBefore) {
  EXPECT_EQ(Sweep(), Presence::kUnknown);
  clock_.Advance(kGrace);
  EXPECT_EQ(Sweep(), Presence::kUnknown);
  clock_.Advance(milliseconds(1));
  EXPECT_EQ(Sweep(), Presence::kOffline);
  EXPECT_EQ(track_.since(), since_);
  EXPECT_THAT(changes_, IsEmpty());
}

TEST_F(OfflineAtSilent, IsOnlineOnceItIsHeardAndOfflineAnewAfterThat) {
  Sign();
  EXPECT_THAT(changes_, ElementsAre(Pair(Presence::kOnline, clock_.System())));
  clock_.Advance(limits_.timeout + milliseconds(1));
  EXPECT_EQ(Sweep(), Presence::kOffline);
  EXPECT_EQ(track_.since(), clock_.System());
  EXPECT_THAT(changes_, SizeIs(2));
}

TEST_F(OfflineAtSilent, IsOfflineAsBeforeAlsoForWhoAdoptsItNext) {
  track_.Adopt({.stored = {Presence::kOffline, since_},
                .unknown_until = clock_.Steady() + kGrace,
                .now = clock_.Steady(),
                .system_now = clock_.System()});
  EXPECT_EQ(Sweep(), Presence::kOffline);
  EXPECT_EQ(track_.since(), since_);
  EXPECT_THAT(changes_, IsEmpty());
}

TEST_F(PresenceTrackTest, AnAdoptedRobotThatIsHeardHereIsOnline) {
  Sign();
  track_.Adopt({.stored = {Presence::kOffline, SystemTime()},
                .unknown_until = clock_.Steady() + std::chrono::hours(1),
                .now = clock_.Steady(),
                .system_now = clock_.System()});
  EXPECT_EQ(track_.presence(), Presence::kOnline);
}

TEST_F(PresenceTrackTest, SilenceCountsOnceThePeerAnsweredAfterIt) {
  Sign();
  clock_.Advance(limits_.timeout - milliseconds(1));
  EXPECT_FALSE(track_.AskBeforeOffline(clock_.Steady(), limits_)) << "it is not silent yet";
  track_.NotePeerAnswered(clock_.Steady(), limits_);
  clock_.Advance(milliseconds(1));
  EXPECT_TRUE(track_.AskBeforeOffline(clock_.Steady(), limits_)) << "that answer came too early";
  EXPECT_EQ(Sweep(), Presence::kOnline);
  for (int i = 0; i < 60; ++i) {
    clock_.Advance(std::chrono::seconds(1));
    EXPECT_TRUE(track_.AskBeforeOffline(clock_.Steady(), limits_));
    EXPECT_EQ(Sweep(), Presence::kUnknown);
  }
  track_.NotePeerAnswered(clock_.Steady(), limits_);
  EXPECT_FALSE(track_.AskBeforeOffline(clock_.Steady(), limits_));
  EXPECT_EQ(Sweep(), Presence::kOffline);
  EXPECT_THAT(changes_, SizeIs(3));
}

TEST_F(PresenceTrackTest, AnAnswerAtTheTimeoutIsEvidenceOfThatSilenceAlone) {
  Sign();
  clock_.Advance(limits_.timeout);
  EXPECT_TRUE(track_.AskBeforeOffline(clock_.Steady(), limits_));
  track_.NotePeerAnswered(clock_.Steady(), limits_);
  clock_.Advance(milliseconds(1));
  EXPECT_FALSE(track_.AskBeforeOffline(clock_.Steady(), limits_));
  EXPECT_EQ(Sweep(), Presence::kOffline);
  Sign();
  clock_.Advance(limits_.timeout + milliseconds(1));
  EXPECT_TRUE(track_.AskBeforeOffline(clock_.Steady(), limits_));
  EXPECT_EQ(Sweep(), Presence::kUnknown);
}

TEST_F(PresenceTrackTest, AnAnswerProvesNoSilenceFromBeforeItsStream) {
  Sign();
  clock_.Advance(limits_.timeout + std::chrono::seconds(5));
  EXPECT_TRUE(track_.AskBeforeOffline(clock_.Steady(), limits_));
  EXPECT_EQ(Sweep(), Presence::kUnknown);
  // It comes back from a server that is cut off, and heard it until now.
  track_.BeginStream(clock_.Steady());
  track_.NotePeerAnswered(clock_.Steady(), limits_);
  clock_.Advance(limits_.timeout - milliseconds(1));
  track_.NotePeerAnswered(clock_.Steady(), limits_);
  EXPECT_FALSE(track_.AskBeforeOffline(clock_.Steady(), limits_)) << "an answer is of no use yet";
  EXPECT_EQ(Sweep(), Presence::kUnknown);
  clock_.Advance(milliseconds(1));
  EXPECT_TRUE(track_.AskBeforeOffline(clock_.Steady(), limits_));
  EXPECT_EQ(Sweep(), Presence::kUnknown);
  track_.NotePeerAnswered(clock_.Steady(), limits_);
  EXPECT_FALSE(track_.AskBeforeOffline(clock_.Steady(), limits_));
  EXPECT_EQ(Sweep(), Presence::kOffline);
}

TEST_F(PresenceTrackTest, AnAnswerWhileItsStreamWasNotReadIsNoEvidenceOfTheSilenceAfter) {
  Sign();
  track_.SetReading(PresenceTrack::Reading::kHeldBack, clock_.Steady());
  clock_.Advance(std::chrono::minutes(10));
  EXPECT_FALSE(track_.AskBeforeOffline(clock_.Steady(), limits_)) << "its silence is ours";
  track_.NotePeerAnswered(clock_.Steady(), limits_);
  track_.SetReading(PresenceTrack::Reading::kFlowing, clock_.Steady());
  clock_.Advance(limits_.timeout + milliseconds(1));
  EXPECT_TRUE(track_.AskBeforeOffline(clock_.Steady(), limits_));
  EXPECT_EQ(Sweep(), Presence::kUnknown);
}

TEST_F(PresenceTrackTest, WhatWasInDoubtHasATimeoutToBeToldElsewhere) {
  Sign();
  clock_.Advance(limits_.timeout + milliseconds(1));
  EXPECT_TRUE(track_.AskBeforeOffline(clock_.Steady(), limits_));
  clock_.Advance(limits_.timeout);
  EXPECT_EQ(Sweep(), Presence::kUnknown);
  clock_.Advance(milliseconds(1));
  EXPECT_EQ(Sweep(), Presence::kOffline);
}

TEST_F(PresenceTrackTest, WhoNeverSpokeOnItsStreamIsInDoubtATimeoutAfterItCame) {
  clock_.Advance(limits_.startup_grace);
  track_.Claim({Presence::kUnknown, clock_.System()}, clock_.Steady());
  clock_.Advance(limits_.timeout - milliseconds(1));
  EXPECT_FALSE(track_.AskBeforeOffline(clock_.Steady(), limits_));
  clock_.Advance(milliseconds(2));
  EXPECT_TRUE(track_.AskBeforeOffline(clock_.Steady(), limits_));
  EXPECT_EQ(Sweep(), Presence::kUnknown);
}

TEST_F(PresenceTrackTest, WhatAnotherJudgesIsNotJudgedHere) {
  Sign();
  track_.Follow({Presence::kUnknown, SystemTime()});
  clock_.Advance(std::chrono::hours(1));
  EXPECT_EQ(Sweep(), Presence::kUnknown);
  EXPECT_EQ(Sign(), PresenceTrack::Sign::kOlder);
  track_.AddStall(clock_.Steady());
  EXPECT_FALSE(track_.AskBeforeOffline(clock_.Steady(), limits_));
  EXPECT_EQ(track_.presence(), Presence::kUnknown);
  EXPECT_FALSE(track_.last_sign());
}

}  // namespace
}  // namespace uplink::robot
