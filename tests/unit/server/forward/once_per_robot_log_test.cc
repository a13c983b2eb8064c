// Robots that the log names, each once.
#include "server/forward/once_per_robot_log.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/forward/limits.h"
#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"

namespace uplink::forward {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class OncePerRobotLogTest : public ::testing::Test {
 protected:
  testing::ManualClock clock_;
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                      log::Level::kInfo};
  OncePerRobotLog told_{logger_, "too_much", "most_from"};
};

TEST_F(OncePerRobotLogTest, EachIsNamedOnceWhileItApplies) {
  EXPECT_TRUE(told_.none());
  told_.Tell({{"a", "b"}, {"c", ""}});
  told_.Tell({{"a", "d"}, {"c", ""}});
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("too_much robot=a most_from=b"),
                                  HasSubstr("too_much robot=c")));
  EXPECT_THAT(lines_.back(), ::testing::Not(HasSubstr("most_from")));
  EXPECT_FALSE(told_.none());
  told_.Tell({});
  EXPECT_TRUE(told_.none());
  told_.Tell({{"c", ""}});
  EXPECT_THAT(lines_, SizeIs(3)) << "it applies anew";
}

TEST_F(OncePerRobotLogTest, WhoIsBeyondTheLinesOfAMinuteIsNamedInTheNextOne) {
  OncePerRobotLog::Robots robots;
  for (std::size_t i = 0; i < kForwardLinesMax; ++i) robots.emplace("a" + std::to_string(i), "");
  robots.emplace("z-honest", "");
  told_.Tell(robots);
  EXPECT_THAT(lines_, SizeIs(kForwardLinesMax));
  lines_.clear();
  told_.Tell(robots);
  EXPECT_THAT(lines_, IsEmpty());
  clock_.Advance(std::chrono::minutes(1));
  told_.Tell(robots);
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("robot=z-honest")));
}

}  // namespace
}  // namespace uplink::forward
