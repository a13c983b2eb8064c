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
  EXPECT_EQ(VoucherOf(facts), Voucher::kNobody);
}

TEST(ClockJudge, IsVouchedForBeforeTheMarkHoweverFar) {
  EXPECT_EQ(VoucherOf({.now = kNow, .mark = kNow + std::chrono::days(1000)}), Voucher::kMark)
      << "less is deleted";
}

TEST(ClockJudge, NobodyVouchesWithoutAMark) {
  EXPECT_EQ(VoucherOf({.now = kNow}), Voucher::kNobody);
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
    EXPECT_EQ(VoucherOf(facts), Voucher::kNobody);
  }
  facts.kernel_synchronised = false;
  facts.database = kNow;
  EXPECT_EQ(VoucherOf(facts), Voucher::kNobody) << "both may have come from the same machine";
}

TEST(ClockJudge, AMarkGoesBackOnlyWhereTheDatabaseAgrees) {
  ClockFacts facts{.now = kNow, .mark = kNow + std::chrono::hours(1)};
  EXPECT_TRUE(MayMoveMark(facts)) << "no database contradicts";
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

TEST(ClockJudge, SaysWhy) {
  ClockFacts facts{.now = kNow, .mark = kNow - std::chrono::days(100)};
  EXPECT_THAT(WhyNobodyVouches(facts),
              AllOf(HasSubstr("8640000 s past the mark"), HasSubstr("kernel")));
  facts.kernel_synchronised = true;
  facts.database = kNow - std::chrono::minutes(2);
  EXPECT_THAT(WhyNobodyVouches(facts),
              AllOf(HasSubstr("database's clock differs by -120 s"), Not(HasSubstr("kernel"))));
  EXPECT_THAT(WhyNobodyVouches({.now = kNow}), HasSubstr("no mark"));
}

}  // namespace
}  // namespace uplink::store
