// Fleets in figures, and the robots that send most.
#include <string>
#include <vector>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/view/json.h"
#include "tests/support/records.h"
#include "tests/support/server_world.h"

namespace uplink::view {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Pair;

class FleetsTest : public ::testing::Test {
 protected:
  FleetsPage Fleets(const FleetsQuery& query = {}) {
    auto page = world_.queries.Fleets(query);
    EXPECT_TRUE(page.ok()) << page.status();
    return page.ok() ? *std::move(page) : FleetsPage();
  }
  static void Tell(robot::Robot& robot, const std::string& agent, const std::string& software) {
    robot.state.KeepReport(model::AgentInfo{.agent_version = agent, .software_version = software},
                           SystemTime());
  }

  testing::ServerWorld world_{100};
};

TEST_F(FleetsTest, CandidatesAreThoseThatWereRefusedLastOfTheseFleets) {
  fleet::Candidates& candidates = world_.fleet.entry().candidates();
  candidates.Note({.robot = {.ruri = "rcan://n/1", .fleet = "north"}}, FromUnixMs(1'000));
  candidates.Note({.robot = {.ruri = "rcan://s/1", .fleet = "south"}}, FromUnixMs(2'000));
  candidates.Note({.robot = {.ruri = "rcan://n/2", .fleet = "north"}, .gateway = "CN=hall"},
                  FromUnixMs(3'000));
  EXPECT_EQ(world_.queries.Candidates(10, {}).size(), 3U);
  EXPECT_EQ(world_.queries.Candidates(10, {"north"}).size(), 2U);
  const auto json = ToJson(world_.queries.Candidates(1, {"north"}));
  ASSERT_TRUE(json.ok()) << json.status();
  EXPECT_EQ(*json, R"({"candidates":[{"ruri":"rcan://n/2","fleet":"north","gateway":"CN=hall",)"
                   R"("refused":"1","firstRefusedAt":"1970-01-01T00:00:03Z",)"
                   R"("lastRefusedAt":"1970-01-01T00:00:03Z"}]})");
}

TEST_F(FleetsTest, CountsTheRobotsOfEach) {
  robot::Robot& stopped = world_.AddRobot("rcan://a", "north");
  model::StatusTelemetry status;
  status.estop = model::EStop{.active = true};
  std::vector<model::Record> records;
  records.push_back(test::RecordOf(status));
  stopped.state.Apply(records, world_.clock.Steady());
  stopped.state.SignOfLife(world_.clock.Steady(), world_.clock.System(), {});
  Tell(stopped, "1.0", "7");
  Tell(world_.AddRobot("rcan://b", "north"), "1.0", "8");
  world_.AddRobot("rcan://c", "south");
  model::Fault fault{.unix_time_ms = 1, .fault_id = "f", .source = "s", .active = true};
  fault.severity = model::FaultSeverity::kCritical;
  world_.CommitFault("rcan://b", fault);

  const FleetsPage page = Fleets();
  ASSERT_EQ(page.fleets.size(), 2U);
  const FleetView& north = page.fleets[0];
  EXPECT_EQ(north.fleet, "north");
  EXPECT_EQ(north.robots, 2);
  EXPECT_EQ(north.presence.online, 1);
  EXPECT_EQ(north.presence.unknown, 1);
  EXPECT_EQ(north.estops, 1);
  EXPECT_THAT(north.agent_versions, ElementsAre(Pair("1.0", 2)));
  EXPECT_THAT(north.software_versions, ElementsAre(Pair("7", 1), Pair("8", 1)));
  ASSERT_TRUE(north.active_faults.has_value());
  EXPECT_THAT(*north.active_faults, ElementsAre(0, 0, 0, 1, 0));
  EXPECT_THAT(*page.fleets[1].active_faults, ElementsAre(0, 0, 0, 0, 0));
  EXPECT_THAT(*ToJson(page), HasSubstr(R"("activeFaults":{"info":"0","minor":"0","major":"0")"
                                       R"(,"critical":"1","unrecognized":"0"})"));
}

TEST_F(FleetsTest, AnswersWhileTheStoreIsAwayThenWithoutFaults) {
  world_.AddRobot("rcan://a", "north");
  world_.reader.SetAway(true);
  const FleetsPage page = Fleets();
  ASSERT_EQ(page.fleets.size(), 1U);
  EXPECT_FALSE(page.fleets[0].active_faults.has_value());
  EXPECT_THAT(*ToJson(page), Not(HasSubstr("activeFaults")));
}

TEST_F(FleetsTest, NamesTheVersionsOfMostRobots) {
  constexpr std::size_t kVersions = kVersionsMax + 2;
  for (std::size_t i = 0; i < kVersions; ++i) {
    Tell(world_.AddRobot(fmt::format("rcan://{:02}", i), "f"), fmt::format("v{:02}", i), "same");
  }
  Tell(world_.AddRobot("rcan://x", "f"), fmt::format("v{:02}", kVersions - 1), "same");
  const FleetView fleet = Fleets().fleets.at(0);
  EXPECT_EQ(fleet.agent_versions.size(), kVersionsMax + 1);
  EXPECT_EQ(fleet.agent_versions.at(std::string(kOtherVersions)), 2);
  EXPECT_EQ(fleet.agent_versions.at(fmt::format("v{:02}", kVersions - 1)), 2);
  EXPECT_EQ(fleet.software_versions.at("same"), static_cast<std::int64_t>(kVersions + 1));
}

TEST_F(FleetsTest, ArePagedAndFilteredByName) {
  for (const char* name : {"c", "a", "b"}) world_.AddRobot(std::string("rcan://") + name, name);
  const FleetsPage first = Fleets({.page_size = 2});
  EXPECT_EQ(first.fleets.at(1).fleet, "b");
  const FleetsPage last = Fleets({.page_size = 2, .page_token = first.next_token});
  EXPECT_EQ(last.fleets.at(0).fleet, "c");
  EXPECT_EQ(last.next_token, "");
  EXPECT_EQ(Fleets({.fleets = {"b"}}).fleets.size(), 1U);
  EXPECT_TRUE(absl::IsInvalidArgument(world_.queries.Fleets({.page_token = "r.41"}).status()));
}

TEST_F(FleetsTest, TheSitesPathsTakeTheirParameters) {
  world_.AddRobot("rcan://a", "north");
  EXPECT_THAT(world_.Get("/api/v1/fleets").body, HasSubstr(R"("fleet":"north","robots":"1")"));
  EXPECT_THAT(world_.Get("/api/v1/fleets?x=1").body, HasSubstr("this path takes fleet, pageSize"));
  EXPECT_EQ(world_.Get("/api/v1/top?by=cost").status, 400);
  EXPECT_EQ(world_.Get("/api/v1/top?pageSize=101").status, 400);
  world_.top.Look();
  world_.clock.Advance(std::chrono::seconds(10));
  world_.fleet.Find("rcan://a")->traffic.CountBytes(100);
  EXPECT_THAT(world_.Get("/api/v1/top").body, HasSubstr(R"({"robots":[],"by":"messages"})"));
  world_.clock.Advance(std::chrono::seconds(10));
  EXPECT_THAT(world_.Get("/api/v1/top?by=bytes&fleet=north&pageSize=100").body,
              HasSubstr(R"("ruri":"rcan://a")"));
  EXPECT_THAT(world_.Get("/api/v1/top?by=bytes&fleet=south").body, Not(HasSubstr("rcan://a")));
}

TEST_F(FleetsTest, TheSitesListOfRobotsTakesEachFilter) {
  world_.AddRobot("rcan://a", "north");
  for (const char* good :
       {"q=A", "offlineBefore=2026-05-01T00:00:00Z", "batteryBelow=20.5", "bbox=-1,-2,3,4.5",
        "software=1", "heldBack=true", "estop=false", "faulted=true", "orderBy=battery",
        "orderBy=-lastHeard", "certificateExpiresBefore=2026-05-01T00:00:00Z", "parts=none",
        "parts=none,motion"}) {
    EXPECT_EQ(world_.Get(std::string("/api/v1/robots?") + good).status, 200) << good;
  }
  for (const char* bad : {"q=",
                          "offlineBefore=yesterday",
                          "batteryBelow=101",
                          "batteryBelow=-1",
                          "batteryBelow=x",
                          "batteryBelow=nan",
                          "bbox=1,2,3",
                          "bbox=1,2,3,4,5",
                          "bbox=1,2,,4",
                          "bbox=181,0,1,1",
                          "bbox=0,5,1,4",
                          "bbox=0,0,1,inf",
                          "heldBack=yes",
                          "estop=",
                          "faulted=1",
                          "orderBy=name",
                          "orderBy=--battery",
                          "parts=nothing",
                          "certificateExpiresBefore=1",
                          "short=a"}) {
    EXPECT_EQ(world_.Get(std::string("/api/v1/robots?") + bad).status, 400) << bad;
  }
  EXPECT_THAT(
      world_.Get("/api/v1/robots?short=a").body,
      HasSubstr(
          "this path takes fleet, q, presence, offlineBefore, label, blocked, batteryBelow, bbox, "
          "software, heldBack, estop, faulted, certificateExpiresBefore, orderBy, "
          "parts, pageSize, pageToken"));
}

}  // namespace
}  // namespace uplink::view
