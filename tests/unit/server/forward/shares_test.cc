// What the shared set may take, and one robot of it.
#include "server/forward/shares.h"

#include <gtest/gtest.h>

namespace uplink::forward {
namespace {

TEST(SharesTest, ARobotEndsAtItsShareAndTheOthersGoOn) {
  Shares shares({.bytes_max = 100, .robot_bytes_max = 40});
  EXPECT_TRUE(shares.Resize("a", 0, 40));
  EXPECT_FALSE(shares.Resize("a", 0, 1));
  EXPECT_TRUE(shares.Resize("b", 0, 40));
  EXPECT_EQ(shares.bytes(), 80U);
}

TEST(SharesTest, AllEndAtTheWhole) {
  Shares shares({.bytes_max = 100, .robot_bytes_max = 60});
  EXPECT_TRUE(shares.Resize("a", 0, 60));
  EXPECT_TRUE(shares.Resize("b", 0, 40));
  EXPECT_FALSE(shares.Resize("c", 0, 1));
  EXPECT_TRUE(shares.Resize("a", 60, 59));
  EXPECT_TRUE(shares.Resize("c", 0, 1));
}

TEST(SharesTest, WhatDoesNotFitChangesNothing) {
  Shares shares({.bytes_max = 100, .robot_bytes_max = 40});
  EXPECT_TRUE(shares.Resize("a", 0, 30));
  EXPECT_FALSE(shares.Resize("a", 30, 41));
  EXPECT_EQ(shares.bytes(), 30U);
  EXPECT_TRUE(shares.Resize("a", 30, 0));
  EXPECT_EQ(shares.bytes(), 0U);
  EXPECT_TRUE(shares.Resize("a", 0, 40));
}

TEST(SharesTest, WhatWasLeftOutIsKnownUntilItIsForgotten) {
  Shares shares({.bytes_max = 1, .robot_bytes_max = 1});
  EXPECT_EQ(shares.left_out(), 0U);
  shares.NoteLeftOut();
  EXPECT_EQ(shares.left_out(), 1U);
  shares.ForgetLeftOut();
  EXPECT_EQ(shares.left_out(), 0U);
}

}  // namespace
}  // namespace uplink::forward
