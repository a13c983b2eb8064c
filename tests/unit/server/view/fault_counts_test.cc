#include "server/view/fault_counts.h"

#include <gtest/gtest.h>

#include "tests/support/server_world.h"

namespace uplink::view {
namespace {

class FaultCountsTest : public ::testing::Test {
 protected:
  [[nodiscard]] absl::Status Refresh() {
    return world_.fault_counts.Refresh(world_.fleet, world_.reader);
  }
  void Raise(const std::string& id, model::FaultSeverity severity) {
    model::Fault fault;
    fault.fault_id = id;
    fault.severity = severity;
    fault.active = true;
    world_.CommitFault("rcan://a", fault);
  }

  testing::ServerWorld world_;
};

TEST_F(FaultCountsTest, AreUnknownBeforeTheFirstLookAndWhenTheyAreOld) {
  EXPECT_EQ(world_.fault_counts.counts(), nullptr);
  ASSERT_TRUE(Refresh().ok());
  ASSERT_NE(world_.fault_counts.counts(), nullptr);
  EXPECT_TRUE(world_.fault_counts.counts()->empty());
  world_.clock.Advance(kFaultCountsAgeMax);
  EXPECT_NE(world_.fault_counts.counts(), nullptr) << "at the limit";
  world_.clock.Advance(milliseconds(1));
  EXPECT_EQ(world_.fault_counts.counts(), nullptr);
}

TEST_F(FaultCountsTest, SayWhatTheStoreSaysAndStayWhileItIsAway) {
  world_.AddRobot("rcan://a");
  world_.AddRobot("rcan://b");
  Raise("f1", model::FaultSeverity::kMajor);
  Raise("f2", model::FaultSeverity::kMajor);
  ASSERT_TRUE(Refresh().ok());
  const auto counts = world_.fault_counts.counts();
  EXPECT_EQ(counts->at("rcan://a")[2], 2);
  EXPECT_FALSE(counts->contains("rcan://b"));
  world_.reader.SetAway(true);
  EXPECT_FALSE(Refresh().ok());
  EXPECT_EQ(world_.fault_counts.counts(), counts);
}

TEST_F(FaultCountsTest, OneQuestionIsUnderWayAtATime) {
  std::vector<std::function<void()>> jobs;
  bool takes = false;
  const auto post = [&](std::function<void()> job) {
    if (takes) jobs.push_back(std::move(job));
    return takes;
  };
  const auto refresh = [&] { world_.fault_counts.RefreshOn(post, world_.fleet, world_.reader); };
  refresh();
  takes = true;
  refresh();
  refresh();
  ASSERT_EQ(jobs.size(), 1U) << "not one more while it waits";
  jobs.front()();
  EXPECT_NE(world_.fault_counts.counts(), nullptr);
  refresh();
  EXPECT_EQ(jobs.size(), 2U);
}

TEST_F(FaultCountsTest, NoneIsAskedForUnlessARobotWasScraped) {
  int jobs = 0;
  const auto post = [&](const std::function<void()>& job) {
    ++jobs;
    job();
    return true;
  };
  world_.robots_scrape.CountFaultsOn(post, world_.reader);
  EXPECT_EQ(jobs, 0);
  static_cast<void>(world_.robots_scrape.Text(metrics::Format::kText, metrics::Coding::kPlain));
  world_.robots_scrape.CountFaultsOn(post, world_.reader);
  EXPECT_EQ(jobs, 1);
  EXPECT_NE(world_.fault_counts.counts(), nullptr);
}

}  // namespace
}  // namespace uplink::view
