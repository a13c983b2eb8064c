#include "server/store/clock_rounds.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/fake_clock_marks.h"
#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"

namespace uplink::store {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// How often a server looks.
constexpr std::chrono::seconds kClockEvery{5};

class ClockRoundsTest : public ::testing::Test {
 protected:
  /// A server that is started now.
  void Start() {
    trust_ = std::make_unique<VouchedClock>(clock_);
    rounds_ = std::make_unique<ClockRounds>(ClockRounds::Context{
        marked_, marks_, *trust_, logger_, [this] { return kernel_synchronised_; }});
    rounds_->Round();
  }
  /// Rounds for as long as that, as they come.
  void Pass(milliseconds span) {
    for (; span.count() > 0; span -= kClockEvery) {
      clock_.Advance(kClockEvery);
      if (marks_.reading.database) *marks_.reading.database += kClockEvery;
      rounds_->Round();
    }
  }
  void Jump(milliseconds by) { clock_.SetSystem(clock_.System() + by); }

  testing::ManualClock clock_;
  const SystemTime start_ = clock_.System();
  testing::FakeClockMarks marks_;
  bool kernel_synchronised_ = false;
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                      log::Level::kInfo};
  MarkedClock marked_{clock_};
  std::unique_ptr<VouchedClock> trust_;
  std::unique_ptr<ClockRounds> rounds_;
};

TEST_F(ClockRoundsTest, AStoreWithoutRowsBeginsWithAMarkOfNow) {
  marks_.empty = true;
  Start();
  EXPECT_EQ(marks_.reading.mark, start_);
  EXPECT_TRUE(trust_->vouched());
  EXPECT_THAT(lines_, IsEmpty());
}

TEST_F(ClockRoundsTest, AStoreThatWasMigratedHasNone) {
  Start();
  EXPECT_FALSE(trust_->vouched());
  EXPECT_THAT(lines_,
              ElementsAre(AllOf(HasSubstr("clock_not_vouched"), HasSubstr("no mark"),
                                HasSubstr("uplinkctl store clock --config FILE --confirm"))));
  Pass(3 * kMarkEvery);
  EXPECT_EQ(marks_.reading.mark, std::nullopt) << "a clock that is not vouched for sets none";
  EXPECT_THAT(lines_, SizeIs(1)) << "told once";
}

TEST_F(ClockRoundsTest, TheKernelGivesAMigratedStoreItsMark) {
  kernel_synchronised_ = true;
  Start();
  EXPECT_TRUE(trust_->vouched());
  Pass(kMarkEvery - kClockEvery);
  EXPECT_EQ(marks_.reading.mark, std::nullopt);
  Pass(kClockEvery);
  EXPECT_EQ(marks_.reading.mark, start_ + kMarkEvery);
}

TEST_F(ClockRoundsTest, AServerThatStartsADayLateIsTrustedAndALaterOneIsNot) {
  marks_.reading.mark = start_ - kPastMarkMax;
  Start();
  EXPECT_TRUE(trust_->vouched());
  marks_.reading.mark = start_ - kPastMarkMax - milliseconds(1);
  Start();
  EXPECT_FALSE(trust_->vouched());
}

TEST_F(ClockRoundsTest, TheMarkFollowsEachMinute) {
  marks_.reading.mark = start_;
  Start();
  Pass(kMarkEvery);
  EXPECT_EQ(marks_.reading.mark, start_ + kMarkEvery);
  Pass(kMarkEvery);
  EXPECT_EQ(marks_.reading.mark, start_ + 2 * kMarkEvery);
}

TEST_F(ClockRoundsTest, TheFirstMarkIsTheDatabasesTime) {
  marks_.empty = true;
  marks_.reading.database = start_ - std::chrono::days(100);
  Start();
  EXPECT_EQ(marks_.reading.mark, start_ - std::chrono::days(100));
  EXPECT_FALSE(trust_->vouched()) << "this server's clock is the one that is wrong";
}

TEST_F(ClockRoundsTest, AJumpOfHoursIsNotTrustedForBeingNearTheMark) {
  marks_.reading.mark = start_;
  Start();
  Jump(std::chrono::hours(12));
  Pass(5 * kMarkEvery);
  EXPECT_FALSE(trust_->vouched()) << "at a start it would be: the server may have been off";
  EXPECT_EQ(marks_.reading.mark, start_);
  marks_.reading.mark = clock_.System();  // an operator confirms it
  Pass(kClockEvery);
  EXPECT_TRUE(trust_->vouched());
  Pass(5 * kMarkEvery);
  EXPECT_TRUE(trust_->vouched());
}

TEST_F(ClockRoundsTest, AJumpThatTheKernelStandsByIsTrustedAfterAWhile) {
  marks_.reading.mark = start_;
  kernel_synchronised_ = true;
  Start();
  Jump(std::chrono::days(100));
  Pass(kKernelNotices);
  EXPECT_FALSE(trust_->vouched());
  Pass(kMarkEvery);
  EXPECT_TRUE(trust_->vouched());
}

TEST_F(ClockRoundsTest, AClockWellBeforeTheMarkIsNotTrustedAndStampsFromTheMarkOn) {
  const SystemTime mark = start_ + std::chrono::days(100);
  marks_.reading.mark = mark;
  EXPECT_EQ(marked_.System(), start_);
  Start();
  EXPECT_FALSE(trust_->vouched());
  EXPECT_EQ(marked_.System(), mark);
  Pass(3 * kMarkEvery);
  EXPECT_EQ(marked_.System(), mark + 3 * kMarkEvery) << "by the monotonic clock";
  EXPECT_EQ(marks_.reading.mark, mark);
  // It comes right: then it counts.
  Jump(std::chrono::days(100) + std::chrono::hours(1));
  Pass(kClockEvery);
  EXPECT_TRUE(trust_->vouched());
  EXPECT_EQ(marked_.System(), clock_.System());
}

TEST_F(ClockRoundsTest, AMarkThatIsWrongStampsNothingWhereTheKernelKnowsBetter) {
  marks_.reading.mark = start_ + std::chrono::days(100);
  kernel_synchronised_ = true;
  Start();
  EXPECT_TRUE(trust_->vouched());
  EXPECT_EQ(marked_.System(), start_);
  Pass(kMarkEvery);
  EXPECT_EQ(marks_.reading.mark, start_ + kMarkEvery);
}

TEST_F(ClockRoundsTest, AMarkOfAServerThatIsAheadStampsNothingWhereTheDatabaseConfirmsOurClock) {
  marks_.reading.mark = start_ + std::chrono::minutes(40);
  marks_.reading.database = start_;
  Start();
  EXPECT_EQ(marked_.System(), start_);
  marks_.reading.database = std::nullopt;
  kernel_synchronised_ = true;
  Start();
  EXPECT_EQ(marked_.System(), start_) << "nor where the kernel does";
}

TEST_F(ClockRoundsTest, ServersThatDifferALittleStampByTheirOwnClocks) {
  marks_.reading.mark = start_ + kBeforeMarkMax;
  Start();
  EXPECT_TRUE(trust_->vouched());
  EXPECT_EQ(marked_.System(), start_);
}

TEST_F(ClockRoundsTest, AJumpWhileTheServerRunsMovesNoMark) {
  marks_.reading.mark = start_;
  Start();
  Jump(std::chrono::days(100));
  EXPECT_FALSE(trust_->vouched()) << "before anybody looked";
  Pass(3 * kMarkEvery);
  EXPECT_FALSE(trust_->vouched());
  EXPECT_EQ(marks_.reading.mark, start_);
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("clock_not_vouched")));
  Jump(-std::chrono::days(100));
  Pass(kClockEvery);
  EXPECT_TRUE(trust_->vouched()) << "it came back";
  EXPECT_THAT(lines_,
              ElementsAre(HasSubstr("clock_not_vouched"), HasSubstr("clock_vouched by=mark")));
  Pass(2 * kMarkEvery);
  EXPECT_GT(*marks_.reading.mark, start_ + kMarkEvery);
  EXPECT_LT(*marks_.reading.mark, start_ + 6 * kMarkEvery);
}

TEST_F(ClockRoundsTest, AMarkIsNotMovedInAMinuteInWhichCivilTimeJumped) {
  marks_.reading.mark = start_;
  marks_.reading.database = start_ + std::chrono::hours(3);
  kernel_synchronised_ = true;
  Start();
  Jump(std::chrono::hours(3));
  Pass(kMarkEvery);
  EXPECT_TRUE(trust_->vouched()) << "the kernel and the database have the same time";
  EXPECT_EQ(marks_.reading.mark, start_);
  Pass(kMarkEvery);
  EXPECT_EQ(marks_.reading.mark, start_ + std::chrono::hours(3) + 2 * kMarkEvery);
}

TEST_F(ClockRoundsTest, AClockThatRunsTooFastMovesNoMark) {
  marks_.reading.mark = start_;
  Start();
  for (int i = 0; i < 24; ++i) {
    Jump(std::chrono::seconds(1));  // a fifth faster
    Pass(kClockEvery);
  }
  EXPECT_EQ(marks_.reading.mark, start_);
}

TEST_F(ClockRoundsTest, AMarkMayGoBack) {
  marks_.reading.mark = start_ + kBeforeMarkTrusted;
  Start();
  Pass(kMarkEvery);
  EXPECT_EQ(marks_.reading.mark, start_ + kBeforeMarkTrusted) << "our clock is not confirmed";
  EXPECT_GT(marked_.System(), start_ + kBeforeMarkTrusted) << "rows are stamped from it on";
  kernel_synchronised_ = true;
  Pass(kMarkEvery);
  EXPECT_EQ(marks_.reading.mark, start_ + 2 * kMarkEvery);
}

TEST_F(ClockRoundsTest, AServerThatIsALittleAheadSetsTheMarkToTheDatabasesTime) {
  marks_.reading.mark = start_;
  marks_.reading.database = start_;
  Jump(std::chrono::minutes(40));
  Start();
  EXPECT_TRUE(trust_->vouched());
  Pass(kMarkEvery);
  EXPECT_EQ(marks_.reading.mark, start_ + kMarkEvery);
  EXPECT_TRUE(trust_->vouched());
}

TEST_F(ClockRoundsTest, NoFirstMarkIsSetWhereKernelAndDatabaseDisagree) {
  marks_.empty = true;
  marks_.reading.database = start_ + std::chrono::days(100);
  kernel_synchronised_ = true;
  Start();
  EXPECT_EQ(marks_.reading.mark, std::nullopt);
  EXPECT_FALSE(trust_->vouched());
  EXPECT_EQ(marked_.System(), start_) << "and rows are stamped by our clock";
}

TEST_F(ClockRoundsTest, OfTwoServersTheWrongOneMovesNoMark) {
  marks_.reading.mark = start_;
  marks_.reading.database = start_;
  Jump(std::chrono::days(100));
  Start();
  Pass(2 * kMarkEvery);
  EXPECT_FALSE(trust_->vouched());
  EXPECT_EQ(marks_.reading.mark, start_) << "one that is ahead";
  Jump(-std::chrono::days(200));
  Start();
  Pass(2 * kMarkEvery);
  EXPECT_EQ(marks_.reading.mark, start_) << "one that is behind";
}

TEST_F(ClockRoundsTest, FollowsAnOperatorWhoConfirmsTheClock) {
  Start();
  EXPECT_FALSE(trust_->vouched());
  marks_.reading.mark = clock_.System();
  Pass(kClockEvery);
  EXPECT_TRUE(trust_->vouched());
}

TEST_F(ClockRoundsTest, NothingIsVouchedForBeforeTheStoreHasAnswered) {
  kernel_synchronised_ = true;
  marks_.status = absl::UnavailableError("away");
  Start();
  EXPECT_FALSE(trust_->vouched()) << "its clock may contradict the kernel";
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("not been read yet")));
  marks_.status = absl::OkStatus();
  Pass(kClockEvery);
  EXPECT_TRUE(trust_->vouched());
}

TEST_F(ClockRoundsTest, GoesByWhatTheStoreSaidLastWhileItIsAway) {
  kernel_synchronised_ = true;
  marks_.reading = {start_ - std::chrono::days(3), start_};
  Start();
  EXPECT_TRUE(trust_->vouched());
  marks_.status = absl::UnavailableError("away");
  Pass(10 * kMarkEvery);
  EXPECT_TRUE(trust_->vouched()) << "the database's clock went on";
  Jump(std::chrono::hours(25));
  Pass(kClockEvery);
  EXPECT_FALSE(trust_->vouched());
}

TEST_F(ClockRoundsTest, AMarkThatCouldNotBeSetInTimeEndsNoTrust) {
  // Of a database whose clock stands, which an operator knows.
  marks_.reading = {start_, start_ - std::chrono::days(1)};
  Start();
  EXPECT_TRUE(trust_->vouched());
  marks_.status = absl::UnavailableError("away");
  Pass(5 * kMarkEvery);
  EXPECT_TRUE(trust_->vouched());
  marks_.status = absl::OkStatus();
  Pass(kMarkEvery);
  EXPECT_TRUE(trust_->vouched());
  EXPECT_EQ(marks_.reading.mark, start_ + 6 * kMarkEvery);
  EXPECT_THAT(lines_, IsEmpty());
}

TEST_F(ClockRoundsTest, AStoreThatWasAwayForDaysEndsNoTrustAndAJumpMeanwhileDoes) {
  marks_.reading.mark = start_;
  Start();
  marks_.status = absl::UnavailableError("away");
  Pass(std::chrono::hours(30));
  EXPECT_TRUE(trust_->vouched());
  Jump(kAdvanceTolerance + std::chrono::seconds(1));
  Pass(kClockEvery);
  EXPECT_FALSE(trust_->vouched());
  Jump(-2 * kAdvanceTolerance - std::chrono::seconds(2));
  Pass(kClockEvery);
  EXPECT_FALSE(trust_->vouched()) << "nor a jump back";
}

TEST_F(ClockRoundsTest, SmallStepsAddUpAndAreNotTrusted) {
  marks_.reading.mark = start_;
  Start();
  marks_.status = absl::UnavailableError("away");
  Pass(std::chrono::hours(24));
  EXPECT_TRUE(trust_->vouched());
  for (int i = 0; i < 7; ++i) {
    Jump(std::chrono::seconds(1));
    Pass(kClockEvery);
  }
  EXPECT_FALSE(trust_->vouched());
}

TEST_F(ClockRoundsTest, OneJobIsUnderWayAtATime) {
  marks_.reading.mark = start_;
  Start();
  std::vector<std::function<void()>> jobs;
  const auto post = [&jobs](std::function<void()> job) {
    jobs.push_back(std::move(job));
    return true;
  };
  rounds_->LookOn(post);
  rounds_->LookOn(post);
  EXPECT_THAT(jobs, SizeIs(1));
  jobs.front()();
  rounds_->LookOn([](const std::function<void()>&) { return false; });
  rounds_->LookOn(post);
  EXPECT_THAT(jobs, SizeIs(2)) << "a queue that is full is asked again";
}

}  // namespace
}  // namespace uplink::store
