#include "server/store/clock_judge.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::store {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr SystemTime kNow = FromUnixMs(1'763'683'200'000);
constexpr milliseconds kTick{1};

TEST(ClockJudge, IsVouchedForUntilADayPastTheMark) {
  ClockFacts facts{.now = kNow, .mark = kNow - kPastMarkMax};
  EXPECT_EQ(VoucherOf(facts), Voucher::kMark);
  facts.mark = *facts.mark - kTick;
  EXPECT_EQ(VoucherOf(facts), Voucher::kNone);
}

TEST(ClockJudge, IsVouchedForUntilADayBeforeTheMark) {
  ClockFacts facts{.now = kNow, .mark = kNow + kBeforeMarkTrusted};
  EXPECT_EQ(VoucherOf(facts), Voucher::kMark);
  facts.mark = *facts.mark + kTick;
  EXPECT_EQ(VoucherOf(facts), Voucher::kNone);
  EXPECT_THAT(WhyNotVouched(facts), HasSubstr("86400 s before the mark"));
  facts.kernel_synchronised = true;
  EXPECT_EQ(VoucherOf(facts), Voucher::kKernel) << "the mark is what is wrong";
}

TEST(ClockJudge, AfterAJumpOnlyAMarkOfNowVouches) {
  ClockFacts facts{.now = kNow, .mark = kNow - kPastMarkDoubtful, .since_jump = milliseconds(0)};
  EXPECT_EQ(VoucherOf(facts), Voucher::kMark) << "an operator set it, or one who has the time";
  facts.mark = *facts.mark - kTick;
  EXPECT_EQ(VoucherOf(facts), Voucher::kNone);
  EXPECT_THAT(WhyNotVouched(facts), HasSubstr("it jumped ahead, and is 120 s past the mark"));
}

TEST(ClockJudge, AfterAJumpTheKernelTakesAWhileToNotice) {
  ClockFacts facts{.now = kNow, .kernel_synchronised = true, .since_jump = kKernelNotices};
  EXPECT_EQ(VoucherOf(facts), Voucher::kNone);
  facts.since_jump = milliseconds(kKernelNotices) + kTick;
  EXPECT_EQ(VoucherOf(facts), Voucher::kKernel);
  facts.since_jump = milliseconds(0);
  facts.database = kNow;
  EXPECT_EQ(VoucherOf(facts), Voucher::kKernel) << "the database confirms it at once";
}

TEST(ClockJudge, FarAheadOfTheDatabaseOnlyAMarkOfNowVouches) {
  ClockFacts facts{
      .now = kNow, .mark = kNow - std::chrono::minutes(10), .database = kNow - kAheadOfDatabaseMax};
  EXPECT_EQ(VoucherOf(facts), Voucher::kMark);
  facts.database = *facts.database - kTick;
  EXPECT_EQ(VoucherOf(facts), Voucher::kNone);
  facts.mark = kNow;
  EXPECT_EQ(VoucherOf(facts), Voucher::kMark) << "an operator knows better than the database";
  facts.mark = kNow - std::chrono::minutes(10);
  facts.database = kNow + std::chrono::days(1);
  EXPECT_EQ(VoucherOf(facts), Voucher::kMark) << "less is deleted";
}

TEST(ClockJudge, OnceVouchedForItsOwnMonotonicClockVouches) {
  ClockFacts facts{.now = kNow,
                   .mark = kNow - std::chrono::days(2),
                   .database = kNow - std::chrono::days(2),
                   .advanced_together = true};
  EXPECT_EQ(VoucherOf(facts), Voucher::kMonotonic);
  EXPECT_TRUE(MayMoveMark(facts)) << "so that the mark follows";
  facts.advanced_together = false;
  EXPECT_EQ(VoucherOf(facts), Voucher::kNone);
  facts.advanced_together = true;
  facts.mark = kNow + kBeforeMarkTrusted + kTick;
  EXPECT_EQ(VoucherOf(facts), Voucher::kNone) << "somebody else who was trusted set it";
}

TEST(ClockJudge, NobodyVouchesWithoutAMark) {
  EXPECT_EQ(VoucherOf({.now = kNow}), Voucher::kNone);
  EXPECT_FALSE(MayMoveMark({.now = kNow}));
}

TEST(ClockJudge, TheKernelVouchesWhereThereIsNoDatabase) {
  EXPECT_EQ(VoucherOf({.now = kNow, .kernel_synchronised = true}), Voucher::kKernel);
}

TEST(ClockJudge, TheKernelVouchesOnlyWithTheDatabase) {
  ClockFacts facts{.now = kNow, .kernel_synchronised = true};
  for (const milliseconds apart :
       {milliseconds(kDatabaseAgreesWithin), -milliseconds(kDatabaseAgreesWithin)}) {
    facts.database = kNow + apart;
    EXPECT_EQ(VoucherOf(facts), Voucher::kKernel);
    facts.database = kNow + apart + (apart.count() > 0 ? kTick : -kTick);
    EXPECT_EQ(VoucherOf(facts), Voucher::kNone);
  }
  facts.kernel_synchronised = false;
  facts.database = kNow;
  EXPECT_EQ(VoucherOf(facts), Voucher::kNone) << "both may have come from the same machine";
}

TEST(ClockJudge, AMarkGoesBackOnlyWhereOurClockIsConfirmed) {
  ClockFacts facts{.now = kNow, .mark = kNow + std::chrono::hours(1)};
  EXPECT_FALSE(MayMoveMark(facts)) << "not confirmed that the mark is the one that is wrong";
  facts.kernel_synchronised = true;
  EXPECT_TRUE(MayMoveMark(facts));
  facts.kernel_synchronised = false;
  facts.database = kNow + std::chrono::hours(1);
  EXPECT_FALSE(MayMoveMark(facts)) << "a server that is wrong moves no mark of others";
  facts.database = kNow;
  EXPECT_TRUE(MayMoveMark(facts));
}

TEST(ClockJudge, AMarkGoesForwardWhileTheClockIsVouchedFor) {
  ClockFacts facts{
      .now = kNow, .mark = kNow - std::chrono::hours(1), .database = kNow + std::chrono::hours(2)};
  EXPECT_TRUE(MayMoveMark(facts));
  facts.mark = kNow - std::chrono::days(2);
  EXPECT_FALSE(MayMoveMark(facts));
}

TEST(ClockJudge, AMarkIsNotSetAheadOfTheDatabase) {
  ClockFacts facts{.now = kNow};
  EXPECT_EQ(MarkToSet(facts), kNow);
  facts.database = kNow + std::chrono::minutes(40);
  EXPECT_EQ(MarkToSet(facts), kNow);
  facts.database = kNow - kAheadOfDatabaseMax;
  EXPECT_EQ(MarkToSet(facts), *facts.database);
  facts.database = *facts.database - kTick;
  EXPECT_EQ(MarkToSet(facts), kNow) << "an operator confirmed it";
}

TEST(ClockJudge, SaysWhy) {
  ClockFacts facts{.now = kNow, .mark = kNow - std::chrono::days(100)};
  EXPECT_THAT(WhyNotVouched(facts),
              AllOf(HasSubstr("8640000 s past the mark"), HasSubstr("kernel")));
  facts.kernel_synchronised = true;
  facts.database = kNow - std::chrono::minutes(2);
  EXPECT_THAT(WhyNotVouched(facts),
              AllOf(HasSubstr("database's clock differs by -120 s"), Not(HasSubstr("kernel"))));
  EXPECT_THAT(WhyNotVouched({.now = kNow}), HasSubstr("no mark"));
}

}  // namespace
}  // namespace uplink::store
