#include "server/robot/rates.h"

#include <string>

#include <gtest/gtest.h>

#include "tests/support/manual_clock.h"

namespace uplink::robot {
namespace {

using model::Variant;

model::Body Upsert(std::string id) {
  model::ReportedShape shape;
  shape.identity.id = std::move(id);
  return model::ShapeOp{shape};
}
model::Body Delete(std::string id) { return model::ShapeOp{model::Deletion{std::move(id)}}; }
model::Body UpsertObject(std::string id) {
  model::Object object;
  object.id = std::move(id);
  return model::ObjectOp{object};
}

class RatesTest : public ::testing::Test {
 protected:
  RatesTest() {
    Set(Variant::kShape, {.rate = 10, .burst = 3});
    Set(Variant::kObject, {.rate = 10, .burst = 3});
    Set(Variant::kSystemHealth, {.rate = 2, .burst = 2});
  }
  void Set(Variant variant, limits::BucketSize size) {
    table_[static_cast<std::size_t>(variant)] = size;
  }
  /// Milliseconds until it may come again; 0: it is taken.
  std::int64_t Limit(const model::Body& body) {
    const auto again = rates_.Limit(body, table_, clock_.Steady());
    EXPECT_TRUE(!again || again->count() > 0);
    return again ? again->count() : 0;
  }
  /// Empties the bucket of shapes.
  void UseUp() {
    for (int i = 0; i < 3; ++i) EXPECT_EQ(Limit(Upsert("used" + std::to_string(i))), 0);
  }

  testing::ManualClock clock_;
  RateTable table_{};
  Rates rates_;
};

TEST_F(RatesTest, WhatHasNoRateIsNeverLimited) {
  for (int i = 0; i < 100'000; ++i) ASSERT_EQ(Limit(model::Fault()), 0);
}

TEST_F(RatesTest, WhetherItWouldLimitIsWhatItThenDoesAndTakesNothing) {
  const auto would = [this](const model::Body& body) {
    return rates_.WouldLimit(body, table_, clock_.Steady());
  };
  EXPECT_FALSE(would(model::Fault())) << "it has no rate";
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(would(Upsert("a")));
  UseUp();
  EXPECT_TRUE(would(Upsert("a")));
  EXPECT_FALSE(would(Delete("a")));
  EXPECT_FALSE(would(UpsertObject("a"))) << "of a bucket of its own";
  EXPECT_EQ(rates_.limited(Variant::kShape), 0U);
  EXPECT_EQ(Limit(Upsert("a")), 100);
  clock_.Advance(milliseconds(99));
  EXPECT_TRUE(would(Upsert("a")));
  clock_.Advance(milliseconds(1));
  EXPECT_FALSE(would(Upsert("a")));
  EXPECT_EQ(Limit(Upsert("a")), 0);
}

TEST_F(RatesTest, PastTheBurstItIsLimitedForAsLongAsItSays) {
  const model::Body health = model::SystemHealth();
  EXPECT_EQ(Limit(health), 0);
  EXPECT_EQ(Limit(health), 0);
  EXPECT_EQ(Limit(health), 500);
  clock_.Advance(milliseconds(499));
  EXPECT_EQ(Limit(health), 1);
  clock_.Advance(milliseconds(1));
  EXPECT_EQ(Limit(health), 0);
  EXPECT_EQ(Limit(health), 500);
  EXPECT_EQ(rates_.limited(Variant::kSystemHealth), 3U);
  rates_.BeginStream();
  EXPECT_EQ(rates_.limited(Variant::kSystemHealth), 0U);
}

TEST_F(RatesTest, EachOfTheIdsThatWaitHasATokenOfItsOwn) {
  UseUp();
  EXPECT_EQ(Limit(Upsert("a")), 100);
  EXPECT_EQ(Limit(Upsert("b")), 200);
  EXPECT_EQ(Limit(Upsert("c")), 300);
  clock_.Advance(milliseconds(100));
  EXPECT_EQ(Limit(Upsert("a")), 0);
  clock_.Advance(milliseconds(100));
  EXPECT_EQ(Limit(Upsert("b")), 0);
  clock_.Advance(milliseconds(100));
  EXPECT_EQ(Limit(Upsert("c")), 0);
}

TEST_F(RatesTest, ALimitedIdStaysSoThoughTokensAreThere) {
  UseUp();
  EXPECT_EQ(Limit(Upsert("a")), 100);
  EXPECT_EQ(Limit(Upsert("b")), 200);
  clock_.Advance(milliseconds(150));
  EXPECT_TRUE(rates_.WouldLimit(Upsert("b"), table_, clock_.Steady()));
  EXPECT_FALSE(rates_.WouldLimit(Upsert("c"), table_, clock_.Steady()));
  EXPECT_EQ(Limit(Upsert("b")), 50) << "later ones of the id too, so that order is kept";
  EXPECT_EQ(Limit(Upsert("c")), 0) << "and others are not";
}

TEST_F(RatesTest, ADeletionTakesATokenAndIsNeverLimited) {
  EXPECT_EQ(Limit(Delete("a")), 0);
  EXPECT_EQ(Limit(Delete("a")), 0);
  EXPECT_EQ(Limit(Upsert("b")), 0);
  EXPECT_EQ(Limit(Upsert("c")), 100);
  EXPECT_EQ(Limit(Delete("c")), 0);
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(Limit(Delete("a")), 0);
  clock_.Advance(milliseconds(100));
  EXPECT_EQ(Limit(Upsert("c")), 0) << "those that found no token owe none";
}

TEST_F(RatesTest, ShapesAndObjectsAreApart) {
  UseUp();
  EXPECT_NE(Limit(Upsert("a")), 0);
  EXPECT_EQ(Limit(UpsertObject("a")), 0);
  EXPECT_EQ(rates_.limited(Variant::kShape), 1U);
  EXPECT_EQ(rates_.limited(Variant::kObject), 0U);
}

TEST_F(RatesTest, PastTheTableEveryUpsertIsLimitedUntilTheLastIsOver) {
  UseUp();
  std::int64_t last = 0;
  for (std::size_t i = 0; i < kLimitedIdsMax; ++i) last = Limit(Upsert(std::to_string(i)));
  EXPECT_GT(last, 0);
  clock_.Advance(milliseconds(1));
  EXPECT_EQ(Limit(Upsert("one more")), last - 1);
  EXPECT_EQ(Limit(Delete("0")), 0);
  clock_.Advance(milliseconds(last));
  EXPECT_EQ(Limit(Upsert("one more")), 0);
  EXPECT_EQ(Limit(Upsert("0")), 0);
}

TEST_F(RatesTest, AnotherTableHoldsAtOnce) {
  UseUp();
  EXPECT_NE(Limit(UpsertObject("a")), 1);
  Set(Variant::kShape, {});
  EXPECT_EQ(Limit(Upsert("a")), 0);
}

}  // namespace
}  // namespace uplink::robot
