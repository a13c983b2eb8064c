#include "server/fleet/presence_watch.h"

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"

namespace uplink::fleet {
namespace {

using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Streams whose peers are asked, by the number of the stream.
struct Asked final : loop::WakeInbox {
  void Wake(std::uint64_t stream) override { ++times[stream]; }
  std::map<std::uint64_t, int> times;
};

class PresenceWatchTest : public ::testing::Test {
 protected:
  /// A handshake that is answered when the test wants.
  void AskRelay() {
    watch_.AskRelay([this](auto done) { waiting_.push_back(std::move(done)); });
  }
  void Answer(bool answered) {
    ASSERT_FALSE(waiting_.empty());
    const auto done = std::move(waiting_.back());
    waiting_.pop_back();
    done(answered);
  }
  /// Sweeps each second.
  void SweepFor(seconds duration) {
    for (seconds passed{0}; passed < duration; ++passed) {
      clock_.Advance(seconds(1));
      watch_.Sweep();
    }
  }

  testing::ManualClock clock_;
  metrics::Cell streams_total_;
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                      log::Level::kInfo};
  metrics::LatencyDistribution sweep_seconds_{metrics::kLatencyBoundsSeconds};
  Fleet fleet_{clock_,
               10,
               {.timeout = seconds(10), .startup_grace = milliseconds(0)},
               {.timeout = seconds(20), .startup_grace = milliseconds(0)}};
  Liveness liveness_{clock_, streams_total_};
  bool others_unseen_ = false;
  PresenceWatch watch_{{clock_, fleet_, liveness_, logger_, sweep_seconds_, std::chrono::hours(1),
                        [this] { return others_unseen_; }}};
  std::vector<std::function<void(bool)>> waiting_;
};

TEST_F(PresenceWatchTest, ARobotIsOfflineOnlyWhileTheRelayAnswers) {
  robot::Robot& robot = **fleet_.FindOrAdmit({"rcan://a", "north"});
  robot.state.SignOfLife(clock_.Steady(), clock_.System(), fleet_.presence_limits());
  AskRelay();
  SweepFor(seconds(11));
  EXPECT_EQ(robot.state.presence(), model::Presence::kUnknown);
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("relay_behind why=late")));
  Answer(true);
  SweepFor(seconds(1));
  EXPECT_TRUE(liveness_.behind()) << "that answer was late";
  AskRelay();
  Answer(true);
  SweepFor(seconds(1));
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("relay_behind"), HasSubstr("relay_caught_up")));
  SweepFor(seconds(9));
  EXPECT_EQ(robot.state.presence(), model::Presence::kUnknown);
  SweepFor(seconds(1));
  EXPECT_EQ(robot.state.presence(), model::Presence::kOffline);
  EXPECT_EQ(sweep_seconds_.count(0), 23U);
}

TEST_F(PresenceWatchTest, OneHandshakeAtATime) {
  AskRelay();
  AskRelay();
  EXPECT_EQ(waiting_.size(), 1U);
  Answer(false);
  AskRelay();
  EXPECT_EQ(waiting_.size(), 1U);
}

TEST_F(PresenceWatchTest, ARefusedHandshakeIsNoAnswer) {
  for (int i = 0; i < 4; ++i) {
    AskRelay();
    Answer(false);
    SweepFor(seconds(1));
  }
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("relay_behind why=refused")));
  AskRelay();
  Answer(true);
  EXPECT_TRUE(liveness_.behind()) << "it was asked four seconds ago";
  AskRelay();
  Answer(true);
  EXPECT_FALSE(liveness_.behind());
}

TEST_F(PresenceWatchTest, AfterAStandstillNobodyIsOfflineUntilAHandshakeBegunAfterwardsIsAnswered) {
  for (const seconds standstill : {seconds(15), seconds(60)}) {
    lines_.clear();
    robot::Robot& robot = **fleet_.FindOrAdmit({"rcan://a", "north"});
    robot.state.SignOfLife(clock_.Steady(), clock_.System(), fleet_.presence_limits());
    SweepFor(seconds(1));
    AskRelay();
    ASSERT_FALSE(liveness_.behind());

    clock_.Advance(standstill);
    watch_.Sweep();
    EXPECT_TRUE(liveness_.behind());
    EXPECT_EQ(robot.state.presence(), model::Presence::kOnline) << "a late sweep judges no robot";
    EXPECT_THAT(lines_, ElementsAre(HasSubstr("standstill_over ms=" +
                                              std::to_string(milliseconds(standstill).count())),
                                    HasSubstr("relay_behind why=stood_still")));

    Answer(true);
    SweepFor(seconds(60));
    EXPECT_TRUE(liveness_.behind()) << "that handshake was under way before";
    EXPECT_EQ(robot.state.presence(), model::Presence::kUnknown);

    AskRelay();
    Answer(true);
    SweepFor(seconds(10));
    EXPECT_FALSE(liveness_.behind());
    EXPECT_EQ(robot.state.presence(), model::Presence::kUnknown) << "a timeout to be heard";
    SweepFor(seconds(1));
    EXPECT_EQ(robot.state.presence(), model::Presence::kOffline);
    EXPECT_THAT(lines_, ElementsAre(HasSubstr("standstill_over"), HasSubstr("relay_behind"),
                                    HasSubstr("relay_caught_up")));
  }
  EXPECT_EQ(liveness_.standstills(), 2);
}

TEST_F(PresenceWatchTest, ASweepThatIsNoMoreThanThreeSecondsLateIsNoStandstill) {
  watch_.Sweep();
  clock_.Advance(Fleet::kSweepLate);
  watch_.Sweep();
  EXPECT_FALSE(liveness_.behind());
  clock_.Advance(Fleet::kSweepLate + milliseconds(1));
  watch_.Sweep();
  EXPECT_TRUE(liveness_.behind());
}

TEST_F(PresenceWatchTest, WhoLeftMayStreamToAServerThatCannotTellAndIsNotOffline) {
  const auto heard = [this](const char* ruri) {
    robot::Robot& robot = **fleet_.FindOrAdmit({ruri, "north"});
    robot.state.SignOfLife(clock_.Steady(), clock_.System(), fleet_.presence_limits());
    return &robot;
  };
  const auto sweep = [this](seconds duration) {
    AskRelay();
    Answer(true);
    SweepFor(duration);
  };
  robot::Robot* const gone = heard("rcan://gone");
  for (int i = 0; i < 6; ++i) sweep(seconds(2));
  ASSERT_EQ(gone->state.presence(), model::Presence::kOffline);

  robot::Robot* const left = heard("rcan://left");
  robot::Robot* const here = heard("rcan://here");
  robot::Robot* const cut = heard("rcan://cut");
  Asked asked;
  static_cast<void>(here->sessions.Attach({&asked, 1}, clock_.Steady(), clock_.System()));
  static_cast<void>(cut->sessions.Attach({&asked, 2}, clock_.Steady(), clock_.System()));
  others_unseen_ = true;
  for (int i = 0; i < 5; ++i) sweep(seconds(2));
  EXPECT_EQ(asked.times[1], 1) << "at the timeout";
  EXPECT_TRUE(here->state.TakeAskPeer());
  EXPECT_FALSE(here->state.TakeAskPeer()) << "once";
  EXPECT_EQ(here->state.presence(), model::Presence::kOnline);
  here->state.NotePeerAnswered(clock_.Steady(), fleet_.presence_limits());
  sweep(seconds(1));
  EXPECT_EQ(here->state.presence(), model::Presence::kOffline) << "it streams here, and is silent";
  for (int i = 0; i < 60; ++i) sweep(seconds(2));
  EXPECT_EQ(left->state.presence(), model::Presence::kUnknown);
  EXPECT_EQ(cut->state.presence(), model::Presence::kUnknown) << "its peer may be gone as well";
  EXPECT_EQ(asked.times[1], 1);
  EXPECT_EQ(asked.times[2], 122) << "at each sweep; its connection has one PING open at a time";
  EXPECT_EQ(gone->state.presence(), model::Presence::kOffline) << "its silence was proven before";

  others_unseen_ = false;
  for (int i = 0; i < 5; ++i) sweep(seconds(2));
  EXPECT_EQ(left->state.presence(), model::Presence::kUnknown) << "the other has time to tell";
  EXPECT_EQ(cut->state.presence(), model::Presence::kUnknown);
  sweep(seconds(1));
  EXPECT_EQ(left->state.presence(), model::Presence::kOffline);
  EXPECT_EQ(cut->state.presence(), model::Presence::kOffline);
}

/// A twin and a relay's robot beside it, whose relay always answers.
class TwinWatchTest : public PresenceWatchTest {
 protected:
  TwinWatchTest() { Hear(twin_); }

  void Hear(robot::Robot& robot) {
    robot.state.SignOfLife(clock_.Steady(), clock_.System(), fleet_.presence_limits_of(robot));
  }
  static void Sweep(PresenceWatch& watch, testing::ManualClock& clock, seconds duration) {
    for (seconds passed{0}; passed < duration; ++passed) {
      watch.AskRelay([](const auto& done) { done(true); });
      clock.Advance(seconds(1));
      watch.Sweep();
    }
  }
  void SweepTwins(seconds duration) { Sweep(twins_watch_, clock_, duration); }

  Fleet::HearingState twins_hear_ = Fleet::HearingState::kUpToDate;
  PresenceWatch twins_watch_{{clock_, fleet_, liveness_, logger_, sweep_seconds_,
                              std::chrono::hours(1), [this] { return others_unseen_; },
                              [this] { return twins_hear_; }}};
  robot::Robot& twin_ = **fleet_.FindOrAdmit(
      {"rcan://local.rcan/cyberwave/sim/3f2504e0-4f89-11d3-9a0c-0305e82c3301", "cyberwave"});
  robot::Robot& beside_ = **fleet_.FindOrAdmit({"rcan://a", "north"});
};

TEST_F(TwinWatchTest, ATwinIsOfflineTwentySecondsAfterItWasHeardAndTheRelaysRobotAfterTen) {
  Hear(beside_);
  SweepTwins(seconds(10));
  EXPECT_EQ(beside_.state.presence(), model::Presence::kOnline);
  SweepTwins(seconds(1));
  EXPECT_EQ(beside_.state.presence(), model::Presence::kOffline);
  SweepTwins(seconds(8));
  EXPECT_EQ(twin_.state.presence(), model::Presence::kOnline) << "19 s";
  SweepTwins(seconds(2));
  EXPECT_EQ(twin_.state.presence(), model::Presence::kOffline) << "21 s";
}

TEST_F(TwinWatchTest, WhileTheBrokerIsNotHeardATwinIsUnknownAndSoItsTimeoutAfter) {
  using enum Fleet::HearingState;
  Hear(beside_);
  twins_hear_ = kBehind;
  SweepTwins(seconds(20));
  EXPECT_EQ(twin_.state.presence(), model::Presence::kOnline) << "it was heard";
  EXPECT_EQ(beside_.state.presence(), model::Presence::kOffline) << "the relay was heard";
  SweepTwins(seconds(600));
  EXPECT_EQ(twin_.state.presence(), model::Presence::kUnknown);
  twins_hear_ = kUpToDate;
  SweepTwins(seconds(20));
  EXPECT_EQ(twin_.state.presence(), model::Presence::kUnknown) << "it has time to be heard";
  SweepTwins(seconds(1));
  EXPECT_EQ(twin_.state.presence(), model::Presence::kOffline);
  twins_hear_ = kBehind;
  SweepTwins(seconds(60));
  EXPECT_EQ(twin_.state.presence(), model::Presence::kOffline) << "its silence was proven before";
}

TEST_F(TwinWatchTest, WithoutABrokerNoTwinBecomesOffline) {
  Hear(beside_);
  Sweep(watch_, clock_, seconds(600));
  EXPECT_EQ(twin_.state.presence(), model::Presence::kUnknown);
  EXPECT_EQ(beside_.state.presence(), model::Presence::kOffline);
}

TEST_F(TwinWatchTest, OtherServersThatCannotTellConcernTheRelaysRobotsAlone) {
  Hear(beside_);
  others_unseen_ = true;
  SweepTwins(seconds(21));
  EXPECT_EQ(twin_.state.presence(), model::Presence::kOffline);
  EXPECT_EQ(beside_.state.presence(), model::Presence::kUnknown);
}

TEST_F(PresenceWatchTest, ARelayThatAnswersMakesNoLine) {
  for (int i = 0; i < 10; ++i) {
    AskRelay();
    Answer(true);
    SweepFor(seconds(1));
  }
  EXPECT_THAT(lines_, IsEmpty());
}

}  // namespace
}  // namespace uplink::fleet
