#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/view/queries.h"
#include "tests/support/records.h"
#include "tests/support/server_world.h"

// What the queries ask of the store.
namespace uplink::view {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

PartSet Parts(std::initializer_list<Part> parts) {
  PartSet set;
  for (const Part part : parts) set.Add(part);
  return set;
}

class StoredQueriesTest : public ::testing::Test {
 protected:
  RobotsPage Robots(const RobotsQuery& query) {
    auto page = world_.queries.Robots(query);
    EXPECT_TRUE(page.ok()) << page.status();
    return page.ok() ? *std::move(page) : RobotsPage();
  }
  /// A robot with every part in the store.
  void AddWithParts(const std::string& ruri) {
    world_.AddRobot(ruri);
    world_.CommitBody(ruri, model::AgentInfo{.agent_version = "a"});
    world_.CommitBody(ruri, model::CurrentSettings{.settings = {{.key = "k", .value = 1.5}}});
    world_.CommitBody(ruri, model::UiCapabilities{});
  }
  void Report(const std::string& mission, const std::string& run, model::MissionStatus status) {
    model::MissionRunStatus report;
    report.mission_id = mission;
    report.run_id = run;
    report.status = status;
    world_.CommitBody("rcan://a", report);
  }
  std::vector<std::string> Runs(const storage::MissionsQuery& query) {
    std::vector<std::string> runs;
    const auto page = world_.queries.List(&storage::Reader::MissionRuns, query);
    for (const storage::MissionRunRow& row : page->rows) runs.push_back(row.run_id);
    return runs;
  }

  testing::ServerWorld world_;
};

TEST_F(StoredQueriesTest, ARobotComesWithWhatTheStoreHasOfIt) {
  AddWithParts("rcan://a");
  world_.AddRobot("rcan://b");
  const auto robot = world_.queries.Robot("rcan://a", {});
  EXPECT_EQ(robot->stored.agent_info, R"({"agentVersion":"a"})");
  EXPECT_EQ(robot->stored.settings, R"({"k":1.5E0})");
  EXPECT_EQ(robot->stored.ui_capabilities, R"({"services":[],"sensors":[],"settings":[]})");
  const auto bare = world_.queries.Robot("rcan://b", {});
  EXPECT_FALSE(bare->stored.agent_info);
  EXPECT_FALSE(bare->stored.settings);
  EXPECT_FALSE(bare->stored.ui_capabilities);
}

TEST_F(StoredQueriesTest, AListAsksTheStoreOnlyForThePartsThatAreWanted) {
  AddWithParts("rcan://a");
  RobotsQuery query;
  const int before = world_.reader.calls();
  EXPECT_FALSE(Robots(query).robots.front().stored.agent_info);
  // The active faults alone.
  EXPECT_EQ(world_.reader.calls(), before + 1);
  query.parts = Parts({Part::kSettings});
  const RobotView robot = Robots(query).robots.front();
  EXPECT_EQ(world_.reader.calls(), before + 3);
  EXPECT_TRUE(robot.stored.settings);
  EXPECT_FALSE(robot.stored.agent_info);
  EXPECT_FALSE(robot.stored.ui_capabilities);
}

TEST_F(StoredQueriesTest, LivePartsAreCopiedOnlyIfOneIsWanted) {
  robot::Robot& robot = world_.AddRobot("rcan://a");
  std::vector<model::Record> records;
  records.push_back(test::RecordOf(model::MotionTelemetry{.unix_time_ms = 1}));
  robot.state.Apply(records, {});
  RobotsQuery query;
  query.parts = Parts({Part::kSettings, Part::kAgentInfo, Part::kUiCapabilities});
  EXPECT_FALSE(Robots(query).robots.front().state.parts.motion);
  query.parts = Parts({Part::kSettings, Part::kHealth});
  EXPECT_TRUE(Robots(query).robots.front().state.parts.motion);
}

TEST_F(StoredQueriesTest, WhileTheStoreIsAwayARobotComesWithoutItsStoredParts) {
  AddWithParts("rcan://a");
  world_.reader.SetAway(true);
  const int before = world_.reader.calls();
  const auto robot = world_.queries.Robot("rcan://a", {});
  ASSERT_TRUE(robot.ok()) << robot.status();
  EXPECT_FALSE(robot->stored.settings);
  // Once it failed it is not asked again: a store that is away may take its time to say so.
  EXPECT_EQ(world_.reader.calls(), before + 1);
}

TEST_F(StoredQueriesTest, WhileTheStoreIsAwayAListThatNamesAStoredPartIsUnavailable) {
  AddWithParts("rcan://a");
  world_.reader.SetAway(true);
  for (const Part part : {Part::kAgentInfo, Part::kSettings, Part::kUiCapabilities}) {
    RobotsQuery query;
    query.parts = Parts({Part::kMotion, part});
    EXPECT_EQ(world_.queries.Robots(query).status().code(), absl::StatusCode::kUnavailable);
  }
  RobotsQuery live;
  live.parts = Parts({Part::kMotion, Part::kHealth});
  EXPECT_TRUE(world_.queries.Robots(live).ok());
  // Nothing to ask for: the page is empty.
  live.filter.fleets = {"other"};
  live.parts = Parts({Part::kSettings});
  EXPECT_TRUE(world_.queries.Robots(live).ok());
}

TEST_F(StoredQueriesTest, APageOfRobotsEndsWhereTheStoreStopped) {
  for (const char* ruri : {"rcan://a", "rcan://b", "rcan://c"}) AddWithParts(ruri);
  world_.reader.SetLatestMax(2);
  RobotsQuery query;
  query.parts = Parts({Part::kAgentInfo});
  const RobotsPage first = Robots(query);
  ASSERT_EQ(first.robots.size(), 2U);
  EXPECT_EQ(first.total, 3);
  query.page_token = first.next_token;
  const RobotsPage last = Robots(query);
  ASSERT_EQ(last.robots.size(), 1U);
  EXPECT_EQ(last.robots.front().id.ruri, "rcan://c");
  EXPECT_TRUE(last.robots.front().stored.agent_info);
  EXPECT_EQ(last.next_token, "");
}

TEST_F(StoredQueriesTest, HistoriesAreOfOneRobot) {
  for (const char* ruri : {"rcan://a", "rcan://b"}) {
    world_.AddRobot(ruri);
    world_.CommitBody(ruri, model::EventTelemetry{1, model::EstopEngagedEvent()});
    world_.CommitBody(ruri, model::Message{1, model::MessageLevel::kInfo, ruri});
    world_.CommitPresence(ruri, model::Presence::kOnline);
  }
  const storage::HistoryQuery query{.ruris = {"rcan://b"}};
  const auto events =
      world_.queries.List(&storage::Reader::Events, storage::EventsQuery{.rows = query});
  ASSERT_EQ(events->rows.size(), 1U);
  EXPECT_EQ(events->rows.front().robot.ruri, "rcan://b");
  EXPECT_EQ(events->rows.front().kind, "estopEngaged");
  const auto messages =
      world_.queries.List(&storage::Reader::Messages, storage::MessagesQuery{.rows = query});
  ASSERT_EQ(messages->rows.size(), 1U);
  EXPECT_EQ(messages->rows.front().message.message, "rcan://b");
  const auto changes = world_.queries.List(&storage::Reader::PresenceChanges, query);
  ASSERT_EQ(changes->rows.size(), 1U);
  EXPECT_EQ(changes->rows.front().presence, model::Presence::kOnline);
}

TEST_F(StoredQueriesTest, MissionRunsAreFiltered) {
  world_.AddRobot("rcan://a");
  Report("m1", "r1", model::MissionStatus::kRunning);
  Report("m1", "r2", model::MissionStatus::kComplete);
  Report("m2", "r1", model::MissionStatus::kPaused);
  storage::MissionsQuery query;
  EXPECT_THAT(Runs(query), ElementsAre("r1", "r2", "r1"));
  query.open = true;
  EXPECT_THAT(Runs(query), ElementsAre("r1", "r1"));
  query.mission_id = "m1";
  EXPECT_THAT(Runs(query), ElementsAre("r1"));
  query.run_id = "r2";
  EXPECT_THAT(Runs(query), IsEmpty());
  query.open = false;
  EXPECT_THAT(Runs(query), ElementsAre("r2"));
}

TEST_F(StoredQueriesTest, ShapesAndObjectsExpireByOurClock) {
  world_.AddRobot("rcan://a");
  const std::int64_t expiry = UnixMs(world_.clock.System()) + 1000;
  model::ReportedShape shape;
  shape.identity.id = "s";
  shape.data = model::GeoPoint2{8, 47};
  shape.expire_time_ms = expiry;
  world_.CommitBody("rcan://a", model::ShapeOp{shape});
  model::Object object;
  object.id = "o";
  object.expires_unix_time_ms = expiry;
  world_.CommitBody("rcan://a", model::ObjectOp{object});

  storage::PresentQuery query;
  // What the caller says of the time does not count.
  query.now = FromUnixMs(expiry);
  world_.clock.Advance(milliseconds(999));
  EXPECT_EQ(world_.queries.Shapes(query)->rows.size(), 1U);
  EXPECT_EQ(world_.queries.Objects(query)->rows.size(), 1U);
  world_.clock.Advance(milliseconds(1));
  EXPECT_EQ(world_.queries.Shapes(query)->rows.size(), 0U);
  EXPECT_EQ(world_.queries.Objects(query)->rows.size(), 0U);
  query.include_expired = true;
  EXPECT_EQ(world_.queries.Shapes(query)->rows.size(), 1U);
  EXPECT_EQ(world_.queries.Objects(query)->rows.size(), 1U);
}

}  // namespace
}  // namespace uplink::view
