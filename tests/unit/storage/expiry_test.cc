#include "storage/expiry.h"

#include <gtest/gtest.h>

namespace uplink::storage {
namespace {

constexpr SystemTime kArrival = FromUnixMs(5'000);

model::Object Expiring(std::int64_t unix_ms) {
  model::Object object;
  object.expires_unix_time_ms = unix_ms;
  return object;
}

TEST(ExpiryOf, IsWhatTheObjectNames) {
  EXPECT_EQ(ExpiryOf(Expiring(7'000), kArrival, {.object_ttl = milliseconds(1)}), 7'000);
  EXPECT_EQ(ExpiryOf(Expiring(7'000), kArrival, {.object_ttl = milliseconds(0)}), 7'000);
  EXPECT_EQ(ExpiryOf(Expiring(1), kArrival, {}), 1);
}

TEST(ExpiryOf, CountsTheConfiguredLifeFromTheArrival) {
  EXPECT_EQ(ExpiryOf(Expiring(0), kArrival, {.object_ttl = milliseconds(1)}), 5'001);
  EXPECT_EQ(ExpiryOf(Expiring(0), kArrival, {}), 5'000 + 86'400'000);
}

TEST(ExpiryOf, IsNeverWhereNoLifeIsConfigured) {
  EXPECT_EQ(ExpiryOf(Expiring(0), kArrival, {.object_ttl = milliseconds(0)}), 0);
}

TEST(IsExpiredTest, IsTrueFromTheTimeOfExpiryOn) {
  EXPECT_FALSE(IsExpired(7'000, 6'999));
  EXPECT_TRUE(IsExpired(7'000, 7'000));
  EXPECT_TRUE(IsExpired(7'000, 7'001));
  EXPECT_FALSE(IsExpired(0, 0)) << "never";
  EXPECT_FALSE(IsExpired(0, 4'102'444'800'000));
}

}  // namespace
}  // namespace uplink::storage
