#include "server/store/robot_load_rounds.h"

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/kept_lines.h"
#include "tests/support/server_world.h"
#include "tests/unit/server/store/known_robot.h"

namespace uplink::store {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class RobotLoadRoundsTest : public ::testing::Test {
 protected:
  /// Keeps the job until the test runs it.
  bool Post(std::function<void()> job) {
    jobs_.push_back(std::move(job));
    return true;
  }
  void ReadOn() {
    rounds_.ReadOn([this](auto job) { return Post(std::move(job)); });
  }

  testing::ServerWorld world_;
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), world_.clock,
                      log::Format::kText, log::Level::kInfo};
  RobotLoadRounds rounds_{
      {world_.fleet, world_.shards, world_.reader, logger_, world_.kRobotsMax, std::nullopt}};
  std::vector<std::function<void()>> jobs_;
};

TEST_F(RobotLoadRoundsTest, BeginsWithTheRobotsOfTheStore) {
  Know(world_.store, "rcan://a", world_.clock.System());
  rounds_.Begin(absl::OkStatus());
  EXPECT_TRUE(rounds_.done());
  EXPECT_EQ(world_.fleet.size(), 1U);
  EXPECT_THAT(lines_, IsEmpty());
  ReadOn();
  EXPECT_THAT(jobs_, IsEmpty()) << "they are read once";
}

TEST_F(RobotLoadRoundsTest, AStoreThatIsAwayIsReadLater) {
  Know(world_.store, "rcan://a", world_.clock.System());
  rounds_.Begin(absl::UnavailableError("gone"));
  EXPECT_FALSE(rounds_.done());
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("store_away why=gone")));
  ReadOn();
  ASSERT_EQ(jobs_.size(), 1U);
  jobs_.front()();
  EXPECT_TRUE(rounds_.done());
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("store_away"), HasSubstr("robots_read robots=1")));
}

TEST_F(RobotLoadRoundsTest, AStoreThatGoesAwayWhileItIsReadIsReadAgain) {
  world_.reader.SetAway(true);
  rounds_.Begin(absl::OkStatus());
  EXPECT_FALSE(rounds_.done());
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("store_away")));
  ReadOn();
  jobs_.front()();
  EXPECT_FALSE(rounds_.done());
  ReadOn();
  EXPECT_EQ(jobs_.size(), 2U);
}

TEST_F(RobotLoadRoundsTest, OneJobIsUnderWayAtATime) {
  rounds_.Begin(absl::UnavailableError("gone"));
  ReadOn();
  ReadOn();
  EXPECT_EQ(jobs_.size(), 1U);
}

TEST_F(RobotLoadRoundsTest, AJobThatIsNotTakenIsAskedForAgain) {
  rounds_.Begin(absl::UnavailableError("gone"));
  rounds_.ReadOn([](const auto& /*job*/) { return false; });
  ReadOn();
  EXPECT_EQ(jobs_.size(), 1U);
}

TEST_F(RobotLoadRoundsTest, OfMoreRobotsThanThereMayBeThoseHeardLastAreTakenAndTheRestIsALine) {
  int age = 0;
  for (const char* ruri : {"a", "b", "c", "d", "e", "f"}) {
    Know(world_.store, ruri, world_.clock.System() + std::chrono::seconds(++age));
  }
  rounds_.Begin(absl::OkStatus());
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("robots_left_out robots=1 robots_max=5")));
  EXPECT_EQ(world_.fleet.size(), 5U);
  EXPECT_EQ(world_.fleet.Find("a"), nullptr);
  EXPECT_NE(world_.fleet.Find("b"), nullptr);
}

TEST_F(RobotLoadRoundsTest, ARobotThatCameMeanwhileHasItsPlaceWhenTheStoreIsReadLater) {
  int age = 0;
  for (const char* ruri : {"a", "b", "c", "d", "e"}) {
    Know(world_.store, ruri, world_.clock.System() + std::chrono::seconds(++age));
  }
  rounds_.Begin(absl::UnavailableError("gone"));
  world_.AddRobot("another");
  ReadOn();
  jobs_.front()();
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("store_away"), HasSubstr("robots_read robots=5"),
                                  HasSubstr("robots_left_out robots=1")));
  EXPECT_EQ(world_.fleet.Find("a"), nullptr);
  EXPECT_NE(world_.fleet.Find("another"), nullptr);
}

TEST_F(RobotLoadRoundsTest, WhyRobotsCannotBeReadIsALineOnce) {
  world_.reader.Fail(absl::InternalError("no such column"));
  rounds_.Begin(absl::OkStatus());
  for (int i = 0; i < 3; ++i) {
    ReadOn();
    jobs_.back()();
  }
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("robots_unread why=\"no such column\"")));
  EXPECT_FALSE(rounds_.done());
  world_.reader.Fail(absl::OkStatus());
  ReadOn();
  jobs_.back()();
  EXPECT_TRUE(rounds_.done());
}

}  // namespace
}  // namespace uplink::store
