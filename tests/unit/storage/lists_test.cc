#include "storage/lists.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::storage {
namespace {

// Tokens that readers hold name lists by these.
TEST(Lists, KeepTheirNumbers) {
  EXPECT_EQ(static_cast<int>(PageKind::kFaultsActive), 1);
  EXPECT_EQ(static_cast<int>(PageKind::kFaultHistory), 2);
  EXPECT_EQ(static_cast<int>(PageKind::kQuarantine), 3);
  EXPECT_EQ(static_cast<int>(PageKind::kGaps), 4);
  EXPECT_EQ(static_cast<int>(PageKind::kEvents), 5);
  EXPECT_EQ(static_cast<int>(PageKind::kMessages), 6);
  EXPECT_EQ(static_cast<int>(PageKind::kMissionRuns), 7);
  EXPECT_EQ(static_cast<int>(PageKind::kMissionReports), 8);
  EXPECT_EQ(static_cast<int>(PageKind::kShapes), 9);
  EXPECT_EQ(static_cast<int>(PageKind::kObjects), 10);
  EXPECT_EQ(static_cast<int>(PageKind::kPresenceChanges), 11);
  EXPECT_EQ(static_cast<int>(PageKind::kScopeUpdates), 12);
  EXPECT_EQ(static_cast<int>(PageKind::kOperatorRequests), 13);
  EXPECT_EQ(static_cast<int>(PageKind::kConnections), 14);
  EXPECT_EQ(static_cast<int>(PageKind::kAudit), 15);
}

TEST(Lists, AreVisitedInTheOrderOfTheirTable) {
  std::vector<PageKind> visited;
  ForEachList([&visited]<PageKind kList>() { visited.push_back(kList); });
  std::vector<PageKind> listed;
  listed.reserve(kLists.size());
  for (const ListEntry& entry : kLists) listed.push_back(entry.kind);
  EXPECT_THAT(visited, ::testing::ElementsAreArray(listed));
}

TEST(Lists, SayHowLongTheirRowsAreKept) {
  EXPECT_EQ(RetainedOf(PageKind::kFaultsActive), Retained::kWhilePresent);
  EXPECT_EQ(RetainedOf(PageKind::kFaultHistory), Retained::kAsHistory);
  EXPECT_EQ(RetainedOf(PageKind::kMissionRuns), Retained::kAsHistory);
  EXPECT_EQ(RetainedOf(PageKind::kQuarantine), Retained::kAsSetAside);
  EXPECT_EQ(RetainedOf(PageKind::kGaps), Retained::kAsSetAside);
  EXPECT_EQ(RetainedOf(PageKind::kConnections), Retained::kAsConnections);
}

}  // namespace
}  // namespace uplink::storage
