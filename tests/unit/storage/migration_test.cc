#include "storage/migration.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::storage {
namespace {

using ::testing::HasSubstr;

constexpr Migration kOurs[] = {{1, 1, "0001_schema", "one", ""}, {2, 1, "0002_more", "two", ""}};

struct Case {
  const char* name;
  std::vector<AppliedStep> applied;
  /// How many of our steps are missing; -1: refused.
  int missing = -1;
  absl::StatusCode code = absl::StatusCode::kOk;
  const char* says = "";
};

class CheckAppliedTest : public ::testing::TestWithParam<Case> {};

TEST_P(CheckAppliedTest, Decides) {
  const auto missing = CheckApplied("store x", GetParam().applied, kOurs);
  EXPECT_EQ(missing.status().code(), GetParam().code) << missing.status();
  EXPECT_EQ(missing.ok() ? static_cast<int>(missing->size()) : -1, GetParam().missing);
  if (missing.ok()) return;
  const std::string text(missing.status().message());
  EXPECT_TRUE(text.starts_with("store x ")) << text;
  EXPECT_THAT(text, HasSubstr(GetParam().says));
}

INSTANTIATE_TEST_SUITE_P(
    Stores, CheckAppliedTest,
    ::testing::Values(
        Case{"AnEmptyStoreLacksAll", {}, 2}, Case{"AnOlderOneLacksTheRest", {{1, 1, "one"}}, 1},
        Case{"OneOfOurSchemaLacksNothing", {{1, 1, "one"}, {2, 1, "two"}}, 0},
        Case{"ANewerOneThatLetsUsInLacksNothing",
             {{1, 1, "one"}, {2, 1, "two"}, {3, 2, "three"}},
             0},
        Case{"ANewerOneThatShutsUsOut",
             {{1, 1, "one"}, {2, 1, "two"}, {3, 3, "three"}},
             -1,
             absl::StatusCode::kUnimplemented,
             "has schema version 3, which shuts out programs of versions below 3, and this"
             " program's is 2: run a newer uplinkd"},
        Case{"OneThatALaterStepLetsInAgainStaysShut",
             {{1, 1, "one"}, {2, 1, "two"}, {3, 3, "three"}, {4, 1, "four"}},
             -1,
             absl::StatusCode::kUnimplemented,
             "has schema version 4, which shuts out programs of versions below 3"},
        Case{"OneWithAnotherStep",
             {{1, 1, "one"}, {2, 1, "other"}},
             -1,
             absl::StatusCode::kUnimplemented,
             "was migrated by another 0002_more than this program's"},
        Case{"OneOfAnEarlierBuild",
             {{1, 0, "old"}, {2, 0, "older"}, {3, 0, "oldest"}},
             -1,
             absl::StatusCode::kUnimplemented,
             "was made by an earlier build, and this program cannot bring it up"}),
    [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace uplink::storage
