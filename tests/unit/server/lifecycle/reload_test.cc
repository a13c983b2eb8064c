#include "server/lifecycle/reload.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::lifecycle {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(CompareConfigs, SeesNothingInTheSame) {
  const Reload reload = CompareConfigs({}, {});
  EXPECT_FALSE(reload.log_level);
  EXPECT_THAT(reload.needs_restart, IsEmpty());
}

TEST(CompareConfigs, TakesTheLogLevelAlone) {
  config::Config read;
  read.log.level = config::LogLevel::kDebug;
  const Reload reload = CompareConfigs({}, read);
  EXPECT_TRUE(reload.log_level);
  EXPECT_THAT(reload.needs_restart, IsEmpty());
}

TEST(CompareConfigs, NamesEveryOtherKeyThatChanged) {
  config::Config read;
  read.listen.http.port = 1;
  read.presence.timeout = config::milliseconds(1);
  const Reload reload = CompareConfigs({}, read);
  EXPECT_FALSE(reload.log_level);
  EXPECT_THAT(reload.needs_restart, ElementsAre("listen.http", "presence.timeout"));
}

}  // namespace
}  // namespace uplink::lifecycle
