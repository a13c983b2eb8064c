#include "server/limits/key_counts.h"

#include <string>

#include <gtest/gtest.h>

namespace uplink::limits {
namespace {

TEST(KeyCounts, AreEachKeysOwn) {
  KeyCounts<std::string> counts;
  counts.Add("a");
  counts.Add("a");
  counts.Add("b");
  counts.Drop("a");
  EXPECT_EQ(counts.Of("a"), 1U);
  EXPECT_EQ(counts.Of("b"), 1U);
  EXPECT_EQ(counts.Of("c"), 0U);
  counts.Drop("a");
  EXPECT_EQ(counts.Of("a"), 0U);
}

}  // namespace
}  // namespace uplink::limits
