#include "server/store/lease_judge.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/manual_clock.h"

namespace uplink::store {
namespace {

using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::Pair;

constexpr storage::ProcessId kSelf{1};
constexpr storage::ProcessId kOther{2};
constexpr storage::ProcessId kThird{3};

constexpr std::chrono::minutes kCutOffMax{10};

class LeaseJudgeTest : public ::testing::Test {
 protected:
  static storage::Lease LeaseOf(const storage::ProcessId& process, std::uint64_t counter,
                                bool released = false) {
    return {
        process, {.name = "host:" + std::to_string(process[0]), .life = "here"}, counter, released};
  }
  void Look(const std::vector<storage::Lease>& leases) { judge_.NoteLook(clock_.Steady(), leases); }
  /// Looks for so long that all show the same, `every` apart.
  void LookOn(const std::vector<storage::Lease>& leases, milliseconds span,
              milliseconds every = kLookEvery) {
    for (milliseconds passed{0}; passed < span; passed += every) {
      clock_.Advance(every);
      Look(leases);
    }
  }
  Over Other() { return judge_.Of(kOther).over; }

  testing::ManualClock clock_;
  bool gone_ = false;
  LeaseJudge judge_{{.self = kSelf,
                     .time_to_move = seconds(10),
                     .is_gone = [this](std::string_view) { return gone_; },
                     .cut_off_max = kCutOffMax}};
};

TEST_F(LeaseJudgeTest, ACounterThatGrowsIsALife) {
  for (std::uint64_t counter = 1; counter < 30; ++counter) {
    Look({LeaseOf(kSelf, 1), LeaseOf(kOther, counter)});
    EXPECT_EQ(Other(), Over::kNo);
    clock_.Advance(kRenewEvery);
  }
  EXPECT_EQ(judge_.others(), 1U);
  EXPECT_EQ(judge_.Of(kOther).counter, 29U);
  EXPECT_EQ(judge_.Of(kOther).name, "host:2");
}

TEST_F(LeaseJudgeTest, TheSameCounterForThirtySecondsIsTheEnd) {
  Look({LeaseOf(kOther, 5)});
  LookOn({LeaseOf(kOther, 5)}, kSilentMax - kLookEvery);
  EXPECT_EQ(Other(), Over::kNo);
  LookOn({LeaseOf(kOther, 5)}, kLookEvery);
  EXPECT_EQ(Other(), Over::kSilent);
  EXPECT_EQ(judge_.others(), 0U);
  clock_.Advance(kLookEvery);
  Look({LeaseOf(kOther, 6)});
  EXPECT_EQ(Other(), Over::kNo) << "it renews and goes on";
}

TEST_F(LeaseJudgeTest, WhoWritesLivesThoughItsCounterStands) {
  Look({LeaseOf(kOther, 5)});
  for (int i = 0; i < 30; ++i) {
    judge_.NoteWritten(kOther, FromUnixMs(i));
    judge_.EndList();
    LookOn({LeaseOf(kOther, 5)}, kLookEvery);
    EXPECT_EQ(Other(), Over::kNo) << i;
  }
  judge_.NoteWritten(kOther, FromUnixMs(29));
  judge_.NoteWritten(kOther, FromUnixMs(3));
  LookOn({LeaseOf(kOther, 5)}, kSilentMax);
  EXPECT_EQ(Other(), Over::kSilent) << "what was written before is no sign";
  judge_.NoteSign(kOther);
  EXPECT_EQ(Other(), Over::kNo);
  EXPECT_EQ(judge_.others(), 1U);
}

TEST_F(LeaseJudgeTest, WhoWasSilentIsNobodyToLeaveRobotsToAfterAGap) {
  Look({LeaseOf(kOther, 5)});
  LookOn({LeaseOf(kOther, 5)}, kSilentMax);
  EXPECT_EQ(judge_.others(), 0U);
  judge_.NoteFailure(clock_.Steady());
  clock_.Advance(kLookEvery);
  Look({LeaseOf(kOther, 5)});
  EXPECT_EQ(Other(), Over::kNo) << "its silence is counted anew";
  EXPECT_EQ(judge_.others(), 0U);
  clock_.Advance(kLookEvery);
  Look({LeaseOf(kOther, 6)});
  EXPECT_EQ(judge_.others(), 1U);
}

TEST_F(LeaseJudgeTest, ACounterThatGrowsIsOfNoProcessThatHasGone) {
  Look({LeaseOf(kOther, 5)});
  gone_ = true;
  for (std::uint64_t counter = 6; counter < 20; ++counter) {
    LookOn({LeaseOf(kOther, counter)}, kLookEvery);
    EXPECT_EQ(Other(), Over::kNo) << "another namespace has the same number";
  }
  LookOn({LeaseOf(kOther, 19)}, seconds(10));
  EXPECT_EQ(Other(), Over::kGone);
}

TEST_F(LeaseJudgeTest, ALookThatFailedBeginsTheTimeAnew) {
  Look({LeaseOf(kOther, 5)});
  LookOn({LeaseOf(kOther, 5)}, kSilentMax - kLookEvery);
  judge_.NoteFailure(clock_.Steady());
  LookOn({LeaseOf(kOther, 5)}, kSilentMax);
  EXPECT_EQ(Other(), Over::kNo);
  LookOn({LeaseOf(kOther, 5)}, kLookEvery);
  EXPECT_EQ(Other(), Over::kSilent);
}

TEST_F(LeaseJudgeTest, ALookThatCameLateBeginsTheTimeAnew) {
  Look({LeaseOf(kOther, 5)});
  LookOn({LeaseOf(kOther, 5)}, seconds(60), kLookGapMax + milliseconds(1));
  EXPECT_EQ(Other(), Over::kNo) << "who looks too seldom sees no silence";
  LookOn({LeaseOf(kOther, 5)}, seconds(36), kLookGapMax);
  EXPECT_EQ(Other(), Over::kSilent);
}

TEST_F(LeaseJudgeTest, OneSingleLookAfterALongTimeProvesNothing) {
  Look({LeaseOf(kOther, 5)});
  clock_.Advance(std::chrono::hours(5));
  Look({LeaseOf(kOther, 5)});
  EXPECT_EQ(Other(), Over::kNo);
}

TEST_F(LeaseJudgeTest, AReleaseIsAnEndOnceItsRobotsHadTimeToCome) {
  Look({LeaseOf(kOther, 5)});
  clock_.Advance(kLookEvery);
  Look({LeaseOf(kOther, 5, true)});
  EXPECT_EQ(Other(), Over::kNo);
  EXPECT_EQ(judge_.others(), 0U) << "it does not go on, though";
  LookOn({LeaseOf(kOther, 5, true)}, seconds(10));
  EXPECT_EQ(Other(), Over::kReleased);
}

TEST_F(LeaseJudgeTest, WhoHadLeftBeforeNeedsNoTime) {
  Look({LeaseOf(kOther, 5, true)});
  EXPECT_EQ(Other(), Over::kReleased);
  Look({LeaseOf(kOther, 5, true), LeaseOf(kThird, 1, true)});
  EXPECT_EQ(judge_.Of(kThird).over, Over::kNo) << "this one left while we looked";
}

TEST_F(LeaseJudgeTest, WhoHadLeftToAnotherLeavesItsRobotsTheTimeToMove) {
  Look({LeaseOf(kOther, 5, true), LeaseOf(kThird, 1)});
  EXPECT_EQ(Other(), Over::kNo);
  LookOn({LeaseOf(kOther, 5, true), LeaseOf(kThird, 1)}, seconds(10));
  EXPECT_EQ(Other(), Over::kReleased);
}

TEST_F(LeaseJudgeTest, AProcessThatIsNotThereAnyMoreIsOver) {
  Look({LeaseOf(kOther, 5)});
  gone_ = true;
  LookOn({LeaseOf(kOther, 5)}, seconds(10) + kLookEvery);
  EXPECT_EQ(Other(), Over::kGone);
}

TEST_F(LeaseJudgeTest, WhoReleasedAndIsGoneReleased) {
  gone_ = true;
  Look({LeaseOf(kOther, 5, true)});
  EXPECT_EQ(Other(), Over::kReleased);
}

TEST(OverTest, OnlyWhoIsKnownToHaveEndedHasEnded) {
  EXPECT_EQ(EndOf(Over::kReleased), storage::HolderEnd::kEnded);
  EXPECT_EQ(EndOf(Over::kGone), storage::HolderEnd::kEnded);
  EXPECT_EQ(EndOf(Over::kSilent), storage::HolderEnd::kSilent);
}

TEST_F(LeaseJudgeTest, WhoHasNoLeaseAtAllIsOverAfterTheSameTime) {
  Look({LeaseOf(kSelf, 1)});
  EXPECT_EQ(Other(), Over::kNo) << "it may be about to take one";
  for (int i = 0; i < 12; ++i) {
    clock_.Advance(kLookEvery);
    Look({LeaseOf(kSelf, 1)});
    if (i < 11) {
      EXPECT_EQ(Other(), Over::kNo) << i;
    }
  }
  EXPECT_EQ(Other(), Over::kSilent) << "it may live, and never have reached its lease";
  EXPECT_EQ(judge_.Of(kOther).counter, 0U);
  EXPECT_EQ(judge_.Of(kOther).name, model::SessionId(kOther).ToHex());
}

TEST_F(LeaseJudgeTest, WhoDoesNotRenewInTimeIsLateForAsLongAsItMayBeCutOff) {
  Look({LeaseOf(kSelf, 1), LeaseOf(kOther, 5)});
  clock_.Advance(kLateAfter - milliseconds(1));
  Look({LeaseOf(kSelf, 1), LeaseOf(kOther, 5)});
  EXPECT_TRUE(judge_.Late().empty());
  clock_.Advance(milliseconds(1));
  Look({LeaseOf(kSelf, 1), LeaseOf(kOther, 5)});
  EXPECT_THAT(judge_.Late(), ElementsAre(Pair(kOther, "host:2")));
  clock_.Advance(kCutOffMax - kLateAfter);
  Look({LeaseOf(kOther, 5)});
  EXPECT_EQ(judge_.Late().size(), 1U);
  clock_.Advance(milliseconds(1));
  Look({LeaseOf(kOther, 5)});
  EXPECT_TRUE(judge_.Late().empty()) << "it is not waited for for ever";
}

TEST_F(LeaseJudgeTest, WhoRenewsWritesOrEndsIsNotLate) {
  const auto late = [this] {
    Look({LeaseOf(kOther, 5)});
    LookOn({LeaseOf(kOther, 5)}, kLateAfter);
    return judge_.Late().size();
  };
  ASSERT_EQ(late(), 1U);
  Look({LeaseOf(kOther, 6)});
  EXPECT_TRUE(judge_.Late().empty()) << "it renewed";
  ASSERT_EQ(late(), 1U);
  judge_.NoteSign(kOther);
  EXPECT_TRUE(judge_.Late().empty()) << "it wrote";
  ASSERT_EQ(late(), 1U);
  Look({LeaseOf(kOther, 5, true)});
  EXPECT_TRUE(judge_.Late().empty()) << "it stopped";
  ASSERT_EQ(late(), 1U);
  gone_ = true;
  Look({LeaseOf(kOther, 5)});
  EXPECT_TRUE(judge_.Late().empty()) << "it is not there";
}

TEST_F(LeaseJudgeTest, HowLongALeaseStoodBeforeIsAskedOfTheStore) {
  storage::Lease lease = LeaseOf(kOther, 5);
  lease.renewed_ago = kLateAfter;
  Look({lease});
  EXPECT_EQ(judge_.Late().size(), 1U);
  lease = LeaseOf(kThird, 5);
  lease.renewed_ago = kCutOffMax + seconds(1);
  Look({lease});
  EXPECT_TRUE(judge_.Late().empty()) << "it was over before this process came";
}

TEST_F(LeaseJudgeTest, TheFirstListOfItsRobotsIsNoSignOfIt) {
  storage::Lease lease = LeaseOf(kOther, 5);
  lease.renewed_ago = kCutOffMax + seconds(1);
  Look({lease});
  judge_.NoteWritten(kOther, FromUnixMs(1));
  judge_.NoteWritten(kOther, FromUnixMs(2));
  clock_.Advance(kLateAfter);
  Look({lease});
  EXPECT_TRUE(judge_.Late().empty()) << "two robots of who was over before are no news";
  judge_.EndList();
  judge_.NoteWritten(kOther, FromUnixMs(2));
  EXPECT_TRUE(judge_.Late().empty());
  judge_.NoteWritten(kOther, FromUnixMs(3));
  clock_.Advance(kLateAfter);
  Look({lease});
  EXPECT_EQ(judge_.Late().size(), 1U) << "it wrote since";
}

TEST_F(LeaseJudgeTest, ASignAfterAGapMayBeAsOldAsTheLookBefore) {
  Look({LeaseOf(kOther, 5)});
  judge_.NoteWritten(kOther, FromUnixMs(1));
  judge_.EndList();
  clock_.Advance(seconds(22));
  judge_.NoteFailure(clock_.Steady());
  Look({LeaseOf(kOther, 5)});
  judge_.NoteWritten(kOther, FromUnixMs(2));
  EXPECT_EQ(judge_.Late().size(), 1U) << "it may be cut off since the sign";
  clock_.Advance(kCutOffMax);
  Look({LeaseOf(kOther, 5)});
  EXPECT_EQ(judge_.Late().size(), 1U) << "and since then only";
  clock_.Advance(milliseconds(1));
  Look({LeaseOf(kOther, 5)});
  EXPECT_TRUE(judge_.Late().empty());
}

TEST_F(LeaseJudgeTest, LooksAtAnotherStoreDoNotGoOnFromThoseBefore) {
  Look({LeaseOf(kOther, 5)});
  LookOn({LeaseOf(kOther, 5)}, kSilentMax - kLookEvery);
  judge_.NoteReplaced();
  LookOn({LeaseOf(kOther, 5)}, kSilentMax);
  EXPECT_EQ(Other(), Over::kNo) << "a renewal may be lost";
  LookOn({LeaseOf(kOther, 5)}, kLookEvery);
  EXPECT_EQ(Other(), Over::kSilent);
}

TEST_F(LeaseJudgeTest, ARobotThatAnotherStoreGivesBackToItsHolderIsNoSignOfIt) {
  storage::Lease lease = LeaseOf(kOther, 5);
  lease.renewed_ago = kCutOffMax + seconds(1);
  Look({lease});
  judge_.NoteWritten(kOther, FromUnixMs(1));
  judge_.EndList();
  judge_.NoteReplaced();
  clock_.Advance(kLateAfter);
  Look({lease});
  judge_.NoteWritten(kOther, FromUnixMs(2));
  judge_.EndList();
  EXPECT_TRUE(judge_.Late().empty()) << "it was written before, and was another's meanwhile";
  judge_.NoteWritten(kOther, FromUnixMs(3));
  clock_.Advance(kLateAfter);
  Look({lease});
  EXPECT_EQ(judge_.Late().size(), 1U) << "it wrote since";
}

TEST_F(LeaseJudgeTest, IsBlindWhileItCannotLookAndNotForEver) {
  Look({LeaseOf(kSelf, 1)});
  EXPECT_FALSE(judge_.blind());
  judge_.NoteFailure(clock_.Steady());
  EXPECT_TRUE(judge_.blind());
  clock_.Advance(kCutOffMax);
  judge_.NoteFailure(clock_.Steady());
  EXPECT_TRUE(judge_.blind());
  clock_.Advance(milliseconds(1));
  judge_.NoteFailure(clock_.Steady());
  EXPECT_FALSE(judge_.blind());
  Look({LeaseOf(kSelf, 1)});
  judge_.NoteFailure(clock_.Steady());
  EXPECT_TRUE(judge_.blind()) << "anew";
}

TEST_F(LeaseJudgeTest, OnesOwnLeaseIsNoOthers) {
  Look({LeaseOf(kSelf, 1)});
  EXPECT_EQ(judge_.others(), 0U);
}

}  // namespace
}  // namespace uplink::store
