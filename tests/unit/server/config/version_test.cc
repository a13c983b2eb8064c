#include "server/config/version.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::config {
namespace {

using ::testing::MatchesRegex;

TEST(VersionTest, NamesTheReleaseAndTheCommit) {
  EXPECT_THAT(std::string(Version()), MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+"));
  EXPECT_THAT(std::string(Commit()), MatchesRegex("[0-9A-Za-z._+~-]+"));
  EXPECT_EQ(VersionText(), std::string(Version()) + " (commit " + std::string(Commit()) + ")");
}

}  // namespace
}  // namespace uplink::config
