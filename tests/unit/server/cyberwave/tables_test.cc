// Tables that forget what was updated least recently, and the times of sessions.
#include <string>

#include <gtest/gtest.h>

#include "server/cyberwave/latest_within.h"
#include "server/cyberwave/session_times.h"

namespace uplink::cyberwave {
namespace {

TEST(LatestWithinTest, HoldsSoManyKeysAndBytes) {
  LatestWithin<int, 3, 100> table;
  EXPECT_EQ(table.Put("a", 1, 10), 0U);
  EXPECT_EQ(table.Put("b", 2, 10), 0U);
  EXPECT_EQ(table.Put("c", 3, 10), 0U);
  EXPECT_EQ(table.Put("a", 4, 10), 0U) << "the same key again";
  EXPECT_EQ(table.Put("d", 5, 10), 1U);
  EXPECT_EQ(table.Find("b"), nullptr) << "least recently updated";
  ASSERT_NE(table.Find("a"), nullptr);
  EXPECT_EQ(*table.Find("a"), 4);
  EXPECT_EQ(table.Put("d", 6, 90), 1U) << "with a there are 100 bytes";
  EXPECT_EQ(table.size(), 2U);
  EXPECT_EQ(table.bytes(), 100U);
  EXPECT_EQ(table.Put("e", 7, 101), 3U) << "it alone has no room";
  EXPECT_EQ(table.size(), 0U);
}

TEST(SessionTimesTest, ComparesWithinASession) {
  SessionTimes times;
  EXPECT_TRUE(times.Take(1, 100));
  EXPECT_TRUE(times.Take(2, 50));
  EXPECT_FALSE(times.Take(1, 99));
  EXPECT_FALSE(times.Take(2, 49));
  EXPECT_TRUE(times.Take(1, 100));
  EXPECT_TRUE(times.Take(1, 0)) << "not known";
  EXPECT_FALSE(times.Take(1, 99));
}

TEST(SessionTimesTest, ForgetsTheSessionThatWasHeardLeastRecently) {
  SessionTimes times;
  for (SessionNumber session = 1; session <= kSessionsOfValueMax; ++session) {
    EXPECT_TRUE(times.Take(session, 100));
  }
  EXPECT_EQ(times.size(), kSessionsOfValueMax);
  EXPECT_TRUE(times.Take(1, 101)) << "heard again";
  EXPECT_TRUE(times.Take(99, 100));
  EXPECT_EQ(times.size(), kSessionsOfValueMax);
  EXPECT_FALSE(times.Take(1, 100));
  EXPECT_TRUE(times.Take(2, 1)) << "it was forgotten";
}

TEST(SessionTimesTest, TellsSessionsApart) {
  EXPECT_EQ(SessionNumberOf("a_live_5d"), SessionNumberOf("a_live_5d"));
  EXPECT_NE(SessionNumberOf("a_live_5d"), SessionNumberOf("a_live_5e"));
}

}  // namespace
}  // namespace uplink::cyberwave
