#include "server/journal/call_size.h"

#include <gtest/gtest.h>

namespace uplink::journal {
namespace {

/// Fails `times` times with as much as it may hold; true if the last failure halved it.
bool Fail(CallSize& size, int times) {
  bool halved = false;
  for (int i = 0; i < times; ++i) halved = size.Failed(size.now());
  return halved;
}

void Succeed(CallSize& size, int times) {
  for (int i = 0; i < times; ++i) size.Succeeded();
}

TEST(CallSizeTest, BeginsWithTheMost) {
  const CallSize size({.most = 100});
  EXPECT_EQ(size.now(), 100U);
}

TEST(CallSizeTest, IsHalvedAfterSoManyFailuresInARow) {
  CallSize size({.most = 100});
  EXPECT_FALSE(Fail(size, kFailuresToHalve - 1));
  EXPECT_EQ(size.now(), 100U);
  EXPECT_TRUE(Fail(size, 1));
  EXPECT_EQ(size.now(), 50U);
  EXPECT_FALSE(Fail(size, kFailuresToHalve - 1)) << "they are counted anew";
  EXPECT_TRUE(Fail(size, 1));
  EXPECT_EQ(size.now(), 25U);
}

TEST(CallSizeTest, ASuccessBetweenFailuresCountsThemAnew) {
  CallSize size({.most = 100});
  static_cast<void>(Fail(size, kFailuresToHalve - 1));
  size.Succeeded();
  EXPECT_FALSE(Fail(size, kFailuresToHalve - 1));
  EXPECT_EQ(size.now(), 100U);
}

TEST(CallSizeTest, IsHalfOfWhatTheFailedCallHeld) {
  CallSize size({.most = 100, .failures_to_halve = 1});
  EXPECT_TRUE(size.Failed(9));
  EXPECT_EQ(size.now(), 4U);
}

TEST(CallSizeTest, IsNeverLessThanOne) {
  CallSize size({.most = 100, .failures_to_halve = 1});
  EXPECT_TRUE(size.Failed(1));
  EXPECT_EQ(size.now(), 1U);
  EXPECT_TRUE(size.Failed(0)) << "of a call that held nothing any more";
  EXPECT_EQ(size.now(), 1U);
}

TEST(CallSizeTest, IsDoubledAfterSoManySuccessesInARow) {
  CallSize size({.most = 100});
  static_cast<void>(Fail(size, 2 * kFailuresToHalve));
  Succeed(size, kSuccessesToDouble - 1);
  EXPECT_EQ(size.now(), 25U);
  Succeed(size, 1);
  EXPECT_EQ(size.now(), 50U);
  Succeed(size, kSuccessesToDouble);
  EXPECT_EQ(size.now(), 100U);
}

TEST(CallSizeTest, AFailureBetweenSuccessesCountsThemAnew) {
  CallSize size({.most = 100});
  static_cast<void>(Fail(size, kFailuresToHalve));
  Succeed(size, kSuccessesToDouble - 1);
  static_cast<void>(Fail(size, 1));
  Succeed(size, kSuccessesToDouble - 1);
  EXPECT_EQ(size.now(), 50U);
}

TEST(CallSizeTest, IsNeverMoreThanTheMost) {
  CallSize size({.most = 100, .failures_to_halve = 1, .successes_to_double = 1});
  EXPECT_TRUE(size.Failed(120));
  EXPECT_EQ(size.now(), 60U);
  size.Succeeded();
  EXPECT_EQ(size.now(), 100U);
  size.Succeeded();
  EXPECT_EQ(size.now(), 100U);
}

TEST(CallSizeTest, ACallThatHeldTooLittleIsNotHalvedButItsFailuresCount) {
  CallSize size({.most = 100, .halved_from = 2});
  for (int i = 0; i < kFailuresToHalve + 1; ++i) EXPECT_FALSE(size.Failed(1));
  EXPECT_EQ(size.now(), 100U);
  EXPECT_TRUE(size.Failed(2)) << "the first that can be";
  EXPECT_EQ(size.now(), 1U);
}

}  // namespace
}  // namespace uplink::journal
