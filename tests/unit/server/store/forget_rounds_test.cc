#include "server/store/forget_rounds.h"

#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/fake_forget_store.h"
#include "tests/support/fake_store.h"
#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"
#include "tests/support/robot_streams.h"

namespace uplink::store {
namespace {

using storage::ForgetAnswer;
using ::testing::_;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;

constexpr storage::ProcessId kSelf{1};
constexpr storage::ProcessId kOther{2};
constexpr storage::Epoch kEpoch = 7;

class ForgetRoundsTest : public ::testing::Test {
 protected:
  ForgetRoundsTest() {
    fleet_.OnPresence(
        [this](const storage::RobotRef& robot, const storage::StoredPresence& now, auto why) {
          journals_.NotePresence(robot, now.presence, now.since, why, now.parked_until);
        });
    trust_.Note(true, ClockPair::Of(clock_));
    requests_.hold_of = [this](const std::string&) { return hold_; };
  }

  void Come() { ASSERT_NE(streams_.Come(kRuri), nullptr); }
  void Go() { streams_.Go(*Shown()); }
  [[nodiscard]] fleet::RobotPtr Shown() const { return fleet_.Find(kRuri); }
  void Write() { streams_.Write(); }
  void Ask(bool end_stream, std::optional<storage::ProcessId> owner = kSelf) {
    const auto number = requests_.Ask(kRuri, end_stream);
    ASSERT_TRUE(number.ok());
    asked_ = *number;
    hold_ = std::nullopt;
    if (owner) hold_ = storage::RobotHold{*owner, kEpoch};
  }
  storage::AnsweredForget AnswerNow() { return *requests_.AnswerTo(asked_); }
  /// What was answered after so many rounds at most.
  storage::AnsweredForget AnswerIn(int rounds) {
    for (int i = 0; i < rounds && AnswerNow().answer == ForgetAnswer::kNone; ++i) {
      rounds_.Round();
      Write();
    }
    return AnswerNow();
  }

  static constexpr const char* kRuri = "rcan://r";
  testing::ManualClock clock_;
  testing::FakeDatabase database_;
  testing::FakeStore store_{database_, kSelf};
  metrics::Ledger ledger_;
  journal::JournalProbe probe_;
  fleet::Fleet fleet_{clock_, 5, {}};
  journal::Journal journal_{store_, {}, clock_, ledger_, probe_, kSelf};
  journal::Shards journals_{{&journal_}};
  testing::RobotStreams streams_{fleet_, journal_, clock_};
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                      log::Level::kInfo};
  testing::FakeForgetStore forget_;
  testing::FakeRobotRemoval& removal_ = forget_.removal();
  testing::FakeForgetRequests& requests_ = forget_.requests();
  std::uint64_t asked_ = 0;
  /// What the store says of the robot's row.
  std::optional<storage::RobotHold> hold_;
  VouchedClock trust_{clock_};
  ForgetRounds rounds_{{.fleet = fleet_,
                        .journals = journals_,
                        .clock = clock_,
                        .logger = logger_,
                        .store = forget_,
                        .process = kSelf,
                        .rows = {.forget_after = std::chrono::hours(24),
                                 .retain_history = std::chrono::hours(72),
                                 .retain_quarantine = std::chrono::hours(48),
                                 .retain_connections = std::chrono::hours(48)},
                        .trust = trust_}};
};

TEST_F(ForgetRoundsTest, ARobotWithoutAStreamLeavesMemoryAndThatIsAnswered) {
  Come();
  Go();
  Ask(false);
  const storage::AnsweredForget answer = AnswerIn(5);
  EXPECT_EQ(answer.answer, ForgetAnswer::kLetGo);
  EXPECT_EQ(answer.epoch, kEpoch);
  EXPECT_EQ(Shown(), nullptr);
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("forget_answered ruri=rcan://r answer=let_go")));
  const auto changes = store_.PresenceChanges({});
  EXPECT_EQ(changes->rows.front().presence, model::Presence::kUnknown)
      << "should it stay in the store, it is not online there for ever";
}

TEST_F(ForgetRoundsTest, OneThatIsNotInMemoryIsLetGoAtOnce) {
  Ask(false);
  EXPECT_EQ(AnswerIn(1).answer, ForgetAnswer::kLetGo);
}

TEST_F(ForgetRoundsTest, AStreamIsARefusal) {
  Come();
  Ask(false);
  EXPECT_EQ(AnswerIn(1).answer, ForgetAnswer::kHasStream);
  EXPECT_NE(Shown(), nullptr);
  EXPECT_FALSE(Shown()->leaving());
  EXPECT_EQ(Shown()->sessions.StandingOf(streams_.stream()), robot::Standing::kCurrent);
}

TEST_F(ForgetRoundsTest, CallsAreARefusalAndEndIfThatIsAsked) {
  Come();
  Go();
  Shown()->calls.Begin(nullptr);
  Ask(false);
  EXPECT_EQ(AnswerIn(1).answer, ForgetAnswer::kHasStream);
  EXPECT_FALSE(Shown()->calls.asked_to_end(clock_.Steady()));
  Ask(true);
  EXPECT_EQ(AnswerIn(3).answer, ForgetAnswer::kNone);
  EXPECT_TRUE(Shown()->calls.asked_to_end(clock_.Steady()));
  Shown()->calls.End(nullptr);
  EXPECT_EQ(AnswerIn(5).answer, ForgetAnswer::kLetGo);
  EXPECT_EQ(Shown(), nullptr);
}

TEST_F(ForgetRoundsTest, AStreamIsEndedIfThatIsAsked) {
  Come();
  EXPECT_GT(streams_.TakeWoken(), 0) << "it came";
  Ask(true);
  EXPECT_EQ(AnswerIn(3).answer, ForgetAnswer::kNone);
  EXPECT_EQ(Shown()->sessions.StandingOf(streams_.stream()), robot::Standing::kEnded);
  EXPECT_GT(streams_.TakeWoken(), 0);
  Go();
  EXPECT_EQ(AnswerIn(5).answer, ForgetAnswer::kLetGo);
  EXPECT_EQ(Shown(), nullptr);
}

TEST_F(ForgetRoundsTest, WhatWaitsForTheStoreIsARefusalOrIsWaitedFor) {
  Come();
  Go();
  const robot::Seen skipped{.missing_first = 1, .missing_last = 1, .missing = 1};
  Shown()->sessions.AddGap(model::SessionId(), skipped);
  Ask(true);
  EXPECT_EQ(AnswerIn(3).answer, ForgetAnswer::kNone);
  EXPECT_NE(Shown(), nullptr);
  requests_.Age(storage::kForgetRequestLives);
  Ask(false);
  EXPECT_EQ(AnswerIn(1).answer, ForgetAnswer::kRecordsWait);
  Shown()->sessions.OnGapsWritten(1);
  Ask(false);
  EXPECT_EQ(AnswerIn(5).answer, ForgetAnswer::kLetGo);
}

TEST_F(ForgetRoundsTest, TheRobotOfAnotherProcessIsNotOursToLetGo) {
  Come();
  Go();
  Ask(false, kOther);
  EXPECT_EQ(AnswerIn(3).answer, ForgetAnswer::kNone);
  EXPECT_NE(Shown(), nullptr);
}

TEST_F(ForgetRoundsTest, InAStoreOfItsOwnTheRobotOfAnEarlierLifeIsItsToLetGo) {
  ForgetRounds alone({.fleet = fleet_,
                      .journals = journals_,
                      .clock = clock_,
                      .logger = logger_,
                      .store = forget_,
                      .process = kSelf,
                      .alone = true,
                      .rows = {},
                      .trust = trust_});
  Ask(false, kOther);  // left out of memory at the start
  alone.Round();
  EXPECT_EQ(AnswerNow().answer, ForgetAnswer::kLetGo);
}

TEST_F(ForgetRoundsTest, ARobotWhoseRowIsGoneIsFollowed) {
  Come();
  Go();
  Ask(false, std::nullopt);
  ASSERT_TRUE(requests_.Finish(asked_, true).ok());
  for (int i = 0; i < 4; ++i) {
    rounds_.Round();
    Write();
  }
  EXPECT_EQ(Shown(), nullptr);
}

TEST_F(ForgetRoundsTest, ARobotThatIsThereAgainStays) {
  Come();
  Ask(false, std::nullopt);
  ASSERT_TRUE(requests_.Finish(asked_, true).ok());
  for (int i = 0; i < 4; ++i) rounds_.Round();
  EXPECT_NE(Shown(), nullptr) << "it has a stream, and is about to have a row";
  Go();
  hold_ = storage::RobotHold{kSelf, kEpoch + 1};
  for (int i = 0; i < 4; ++i) rounds_.Round();
  EXPECT_NE(Shown(), nullptr) << "it has a row";
}

TEST_F(ForgetRoundsTest, AStreamOfARobotWhoseRowWasRemovedIsOpenedAnew) {
  Come();
  Ask(false, std::nullopt);
  static_cast<void>(requests_.Finish(asked_, true));
  rounds_.Round();
  Write();
  EXPECT_EQ(Shown()->state.held_since(), 0U);
  EXPECT_EQ(Shown()->sessions.StandingOf(streams_.stream()), robot::Standing::kSuperseded);
}

TEST_F(ForgetRoundsTest, ARobotThatIsLetGoAndSpeaksIsOnlineInTheHistoryAgain) {
  Come();
  Go();
  Ask(false);
  rounds_.Round();  // unknown is on its way to the store
  Come();
  Write();
  EXPECT_EQ(Shown()->state.presence(), model::Presence::kOnline);
  const auto changes = store_.PresenceChanges({});
  EXPECT_EQ(changes->rows.front().presence, model::Presence::kOnline);
}

TEST_F(ForgetRoundsTest, ARowThatIsGoneIsALineOnceAndThoseOfBeforeTheStartAreNone) {
  Ask(false, std::nullopt);
  static_cast<void>(requests_.Finish(asked_, true));
  rounds_.Round();
  EXPECT_THAT(lines_, IsEmpty());
  Ask(false, std::nullopt);
  static_cast<void>(requests_.Finish(asked_, true));
  rounds_.Round();
  rounds_.Round();
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("robot_removed ruri=rcan://r came_back=false")));
}

TEST_F(ForgetRoundsTest, ARobotThatWasRemovedAndIsThereAgainIsALine) {
  rounds_.Round();
  Ask(true);
  ASSERT_TRUE(requests_.Finish(asked_, true).ok());
  hold_ = storage::RobotHold{kSelf, kEpoch};
  rounds_.Round();
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("robot_removed ruri=rcan://r came_back=true")));
}

TEST_F(ForgetRoundsTest, ARobotThatStayedIsALine) {
  rounds_.Round();
  Ask(false);
  ASSERT_TRUE(requests_.Finish(asked_, false).ok());
  rounds_.Round();
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("forget_given_up ruri=rcan://r")));
}

TEST_F(ForgetRoundsTest, ARobotThatAnEarlierBuildRemovedIsALine) {
  rounds_.Round();
  Ask(false, std::nullopt);
  ASSERT_TRUE(requests_.Finish(asked_, false).ok());
  rounds_.Round();
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("robot_removed ruri=rcan://r came_back=false")));
}

TEST_F(ForgetRoundsTest, AStoreThatIsAwayIsAskedAgain) {
  Ask(false);
  requests_.status = absl::UnavailableError("away");
  EXPECT_EQ(rounds_.Round(), kLookAgainEvery);
  EXPECT_EQ(rounds_.Round(), kLookAgainEvery);
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("forget_fails why=away"))) << "once";
  requests_.status = absl::OkStatus();
  EXPECT_EQ(AnswerNow().answer, ForgetAnswer::kNone);
  EXPECT_EQ(AnswerIn(1).answer, ForgetAnswer::kLetGo);
  EXPECT_THAT(lines_,
              ElementsAre(_, HasSubstr("forget_answered"), HasSubstr("forget_works_again")));
}

TEST_F(ForgetRoundsTest, SilentRowsThatFailAreALineAndHoldNoRequestUp) {
  removal_.remove_status = absl::UnavailableError("locked");
  removal_.silent = {{"rcan://gone", 3}};
  EXPECT_EQ(rounds_.Round(), kLookForForgottenEvery);
  EXPECT_EQ(rounds_.Round(), kLookForForgottenEvery);
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("forget_fails why=locked"))) << "once";
  Ask(false);
  EXPECT_EQ(AnswerIn(1).answer, ForgetAnswer::kLetGo);
  removal_.remove_status = absl::OkStatus();
  clock_.Advance(kRemoveSilentAgainAfter);
  rounds_.Round();
  EXPECT_THAT(removal_.removed, ElementsAre(Pair("rcan://gone", 3)));
  EXPECT_THAT(lines_.back(), HasSubstr("forget_works_again"));
}

TEST_F(ForgetRoundsTest, AnAnswerThatDoesNotReachTheStoreIsGivenAgain) {
  Ask(false);
  requests_.answer_status = absl::UnavailableError("away");
  EXPECT_EQ(rounds_.Round(), kLookAgainEvery);
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("forget_fails why=away")));
  requests_.answer_status = absl::OkStatus();
  EXPECT_EQ(AnswerIn(1).answer, ForgetAnswer::kLetGo);
}

}  // namespace
}  // namespace uplink::store
