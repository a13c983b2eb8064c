#include "server/limits/recent_keys.h"

#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace uplink::limits {
namespace {

using Keys = RecentKeys<std::string, int, 3>;

TEST(RecentKeys, ForgetThatWhichWasTouchedLeastRecently) {
  struct Row {
    std::vector<std::string> touched;
    /// How often each that is known was touched since it came.
    std::map<std::string, int> known;
  };
  for (const Row& row : std::vector<Row>{
           {{}, {}},
           {{"a", "b", "c"}, {{"a", 1}, {"b", 1}, {"c", 1}}},
           {{"a", "b", "c", "d"}, {{"b", 1}, {"c", 1}, {"d", 1}}},
           {{"a", "b", "c", "a", "d"}, {{"a", 2}, {"c", 1}, {"d", 1}}},
           {{"a", "b", "c", "d", "a"}, {{"a", 1}, {"c", 1}, {"d", 1}}},
       }) {
    Keys keys;
    for (const std::string& key : row.touched) ++keys.Touch(key);
    EXPECT_EQ(keys.size(), row.known.size());
    for (const auto& [key, times] : row.known) {
      ASSERT_NE(keys.Find(key), nullptr) << key;
      EXPECT_EQ(*keys.Find(key), times) << key;
    }
  }
}

TEST(RecentKeys, ForgetThoseThatAreDoneUpToTheFirstThatIsNot) {
  Keys keys;
  keys.Touch("a") = 1;
  keys.Touch("b") = 2;
  keys.Touch("c") = 1;
  keys.ForgetWhile([](int value) { return value == 1; });
  EXPECT_EQ(keys.Find("a"), nullptr);
  EXPECT_NE(keys.Find("b"), nullptr);
  EXPECT_NE(keys.Find("c"), nullptr) << "b stands before it";
  keys.ForgetWhile([](int) { return true; });
  EXPECT_EQ(keys.size(), 0U);
}

}  // namespace
}  // namespace uplink::limits
