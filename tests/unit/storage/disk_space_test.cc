#include "storage/disk_space.h"

#include <gtest/gtest.h>

namespace uplink::storage {
namespace {

TEST(DiskSpaceTest, SaysWhatTheDiskOfAPathHas) {
  const auto space = DiskSpaceOf(".");
  ASSERT_TRUE(space.ok()) << space.status();
  EXPECT_GT(space->total_bytes, 0U);
  EXPECT_LE(space->free_bytes, space->total_bytes);
}

TEST(DiskSpaceTest, NamesAPathThatIsNotThere) {
  const auto space = DiskSpaceOf("/nowhere/at/all");
  EXPECT_EQ(space.status().code(), absl::StatusCode::kUnavailable);
  EXPECT_NE(space.status().message().find("/nowhere/at/all"), std::string::npos);
}

}  // namespace
}  // namespace uplink::storage
