#include "tools/uplink-fleet/robot/backoff.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::synthetic {
namespace {

using ::testing::AllOf;
using ::testing::Ge;
using ::testing::Le;

TEST(Backoff, DoublesItsWaitWithEachFailureUpToTheBound) {
  Backoff backoff(1);
  for (const milliseconds most :
       {milliseconds(100), milliseconds(200), milliseconds(400), milliseconds(800),
        milliseconds(1600), milliseconds(2000), milliseconds(2000)}) {
    EXPECT_THAT(backoff.Next(), AllOf(Ge(most / 2), Le(most)));
    backoff.Failed();
  }
}

TEST(Backoff, BeginsAnewAfterASuccess) {
  Backoff backoff(1);
  for (int i = 0; i < 10; ++i) backoff.Failed();
  backoff.Succeeded();
  EXPECT_THAT(backoff.Next(), Le(milliseconds(100)));
}

TEST(Backoff, DrawsTheSameWaitsForTheSameSeed) {
  Backoff one(42);
  Backoff other(42);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(one.Next(), other.Next());
}

}  // namespace
}  // namespace uplink::synthetic
