#include "server/session/judged.h"

#include <gtest/gtest.h>

#include "tests/support/fake_trust.h"
#include "tests/support/manual_clock.h"

namespace uplink::session {
namespace {

const testing::FakeTrust kVouched;

model::Body ShapeUntil(std::int64_t at_ms) {
  model::ReportedShape shape;
  shape.expire_time_ms = at_ms;
  return model::ShapeOp{shape};
}

model::Body ObjectUntil(std::int64_t at_ms) {
  model::Object object;
  object.expires_unix_time_ms = at_ms;
  return model::ObjectOp{object};
}

TEST(ExpiryTest, AnUpsertHasExpiredOnceItsTimeHasCome) {
  const SystemTime now = testing::ManualClock().System();
  EXPECT_TRUE(ExpiredOnArrival(ShapeUntil(UnixMs(now)), now, kVouched));
  EXPECT_FALSE(ExpiredOnArrival(ShapeUntil(UnixMs(now) + 1), now, kVouched));
  EXPECT_TRUE(ExpiredOnArrival(ObjectUntil(UnixMs(now)), now, kVouched));
  EXPECT_FALSE(ExpiredOnArrival(ObjectUntil(UnixMs(now) + 1), now, kVouched));
}

TEST(ExpiryTest, NothingHasExpiredByAClockThatNobodyVouchesFor) {
  const SystemTime now = testing::ManualClock().System();
  const testing::FakeTrust trust(false);
  EXPECT_FALSE(ExpiredOnArrival(ShapeUntil(UnixMs(now)), now, trust));
  EXPECT_FALSE(ExpiredOnArrival(ObjectUntil(UnixMs(now)), now, trust));
}

TEST(ExpiryTest, WithoutAnExpiryNothingExpires) {
  const SystemTime now = testing::ManualClock().System();
  EXPECT_FALSE(ExpiredOnArrival(ShapeUntil(0), now, kVouched));
  EXPECT_FALSE(ExpiredOnArrival(ObjectUntil(0), now, kVouched));
  EXPECT_FALSE(ExpiredOnArrival(model::Fault(), now, kVouched));
}

}  // namespace
}  // namespace uplink::session
