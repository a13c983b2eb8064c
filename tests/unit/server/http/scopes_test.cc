#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/http/routes.h"
#include "storage/origin.h"
#include "storage/samples.h"
#include "tests/support/server_world.h"

// What a caller of few fleets is shown: byte for byte what a server without all other robots shows.
namespace uplink::http {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::ServerWorld;

const std::string kNorth = "rcan://a";
const std::string kSouth = "rcan://b";
const std::string kNobody = storage::NoRobotOf("hall");

/// A server of a fleet `north` with one robot, and if `all`, of much else that is not its own.
class World {
 public:
  explicit World(bool all) {
    world_.top.Look();
    Fill("north", kNorth);
    if (!all) {
      world_.clock.Advance(milliseconds(2));
      return;
    }
    world_.clock.Advance(milliseconds(1));
    Fill("south", kSouth);
    // Of the caller's fleet, and of no robot.
    const auto nobody = std::make_shared<const model::RobotId>(model::RobotId{kNobody, "north"});
    storage::CommitRecord rejected = Next(nobody);
    rejected.content = storage::QuarantineItem{{model::RejectReason::kMalformed, "", ""}};
    rejected.origin = storage::OriginOf(model::MessageSource::kCyberwave, "topic");
    world_.Commit(kNobody, {rejected});
    world_.CommitScopeUpdate({model::ScopeKind::kEnvironment, kId, "a", "{}", 0}, "north");
  }

  Response Get(const std::string& target, const identity::Scope& scope) {
    // No text of a scrape is shared, and rates have a time.
    world_.clock.Advance(std::chrono::seconds(10));
    Request request{Method::kGet, target};
    request.caller = {.role = identity::Role::kViewer, .scope = scope, .name = "t"};
    return world_.Get(request);
  }

  ServerWorld& world() { return world_; }

 private:
  static constexpr const char* kId = "eeeeeeee-eeee-4eee-8eee-eeeeeeeeeeee";

  storage::CommitRecord Next(const storage::RobotRef& robot) {
    const storage::OpenRequest open{
        .robot = robot, .session = ServerWorld::session(), .at = world_.clock.System()};
    const auto opened = world_.store.OpenStreams({&open, 1});
    EXPECT_TRUE(opened.ok());
    return {.robot = robot,
            .session = ServerWorld::session(),
            .seq = 1'000 + ++numbers_,
            .held_since = opened->front().held_since,
            .received_at = world_.clock.System(),
            .content = storage::QuarantineItem{}};
  }

  /// A robot with a row in every list.
  void Fill(const std::string& fleet, const std::string& ruri) {
    robot::Robot& robot = world_.AddRobot(ruri, fleet);
    robot.state.SignOfLife(world_.clock.Steady(), world_.clock.System(), {});
    robot.traffic.CountMessages(100);
    world_.CommitBody(ruri, model::Message{1, model::MessageLevel::kInfo, ruri});
    world_.CommitBody(ruri, model::EventTelemetry{1, model::EstopEngagedEvent{}});
    world_.CommitPresence(ruri, model::Presence::kOnline);
    world_.CommitGap(ruri, 500, 500);
    world_.CommitFault(ruri, {.unix_time_ms = 1, .fault_id = "f", .source = "s", .active = true});
    world_.CommitQuarantine(ruri, {model::RejectReason::kMalformed, "", ruri}, "bytes");
    model::MissionRunStatus report;
    report.mission_id = "m";
    report.run_id = ruri;
    report.status = model::MissionStatus::kRunning;
    world_.CommitBody(ruri, report);
    model::ReportedShape shape;
    shape.identity.id = ruri;
    shape.data = model::GeoPoint2{8, 47};
    world_.CommitBody(ruri, model::ShapeOp{shape});
    model::Object object;
    object.id = ruri;
    world_.CommitBody(ruri, model::ObjectOp{object});
    storage::ConnectionItem connection;
    connection.robot = robot.id();
    connection.id = {++connections_};
    connection.began_at = world_.clock.System();
    connection.address = ruri;
    world_.CommitConnection(std::move(connection));
    Ask(robot.id());
  }
  /// A drone's request to its operator.
  void Ask(const storage::RobotRef& robot) {
    storage::CommitRecord asks = Next(robot);
    const storage::ClaimRequest request{robot, world_.clock.System()};
    const auto claimed = world_.store.ClaimDrones({&request, 1});
    ASSERT_TRUE(claimed.ok());
    asks.content = model::OperatorRequest{.request_id = robot->ruri, .open = true};
    asks.sample = std::make_shared<const storage::SampleMark>(
        storage::SampleMark{.claim = claimed->front().claim});
    world_.Commit(robot->ruri, {asks});
  }

  ServerWorld world_{100};
  model::Seq numbers_ = 0;
  std::uint8_t connections_ = 0;
};

/// What is asked of each path that shows robots or their rows; the first of each shows all.
std::map<std::string_view, std::vector<std::string>> Questions() {
  std::map<std::string_view, std::vector<std::string>> questions;
  for (const Route& route : Routes()) {
    const std::string path(route.pattern);
    if (route.lane != Lane::kRead || path.find("/robot") != std::string::npos) continue;
    if (route.needs.whole || !route.action.empty()) continue;
    std::vector<std::string>& asked = questions[route.name];
    for (const char* query : {"", "?fleet=south", "?fleet=north", "?pageSize=1"}) {
      asked.push_back(path + query);
    }
    if (path == "/api/v1/scope-updates") continue;
    for (const std::string& ruri : {kNorth, kSouth, kNobody}) {
      asked.push_back(path + "?ruri=" + ruri);
      asked.push_back(path + "?fleet=north&ruri=" + ruri);
    }
    asked.push_back(path + "?ruri=" + kSouth + "&ruri=" + kNorth + "&ruri=" + kNobody);
  }
  questions["faults"].emplace_back("/api/v1/faults?active=true");
  questions["missions"].emplace_back("/api/v1/missions?open=true");
  questions["operator_requests"].emplace_back("/api/v1/operator-requests?open=true");
  questions["quarantine"].emplace_back("/api/v1/quarantine?source=cyberwave");
  questions["robots"] = {"/api/v1/robots",
                         "/api/v1/robots?fleet=south",
                         "/api/v1/robots?fleet=north",
                         "/api/v1/robots?pageSize=1",
                         "/api/v1/robots?q=b",
                         "/api/v1/robots?faulted=true",
                         "/api/v1/robots?orderBy=-lastHeard",
                         "/api/v1/robots?parts=settings"};
  questions["fleets"] = {"/api/v1/fleets", "/api/v1/fleets?pageSize=1",
                         "/api/v1/fleets?fleet=south"};
  questions["top"] = {"/api/v1/top", "/api/v1/top?fleet=south", "/api/v1/top?pageSize=1"};
  questions["robot_by_ruri"] = {"/api/v1/robot?ruri=" + kSouth, "/api/v1/robot?ruri=" + kNorth,
                                "/api/v1/robot?ruri=" + kNobody};
  questions["robot"] = {"/api/v1/robots/rcan%3A%2F%2Fb", "/api/v1/robots/rcan%3A%2F%2Fa"};
  questions["robot_story"] = {
      "/api/v1/robot/story?ruri=" + kSouth, "/api/v1/robot/story?ruri=" + kNorth,
      "/api/v1/robot/story?pageSize=1&ruri=" + kNorth, "/api/v1/robot/story?ruri=" + kNobody,
      "/api/v1/robot/story?pageToken=x&ruri=" + kSouth};
  questions["metrics_robots"] = {"/metrics/robots"};
  return questions;
}

TEST(Scopes, EachPathOfRobotsIsAskedAndTheOthersSpeakOfTheWholeServer) {
  const auto questions = Questions();
  std::vector<std::string_view> others;
  for (const Route& route : Routes()) {
    // Commands: commands_test.cc.
    if (!questions.contains(route.name) && route.action.empty()) others.push_back(route.name);
  }
  EXPECT_THAT(others, ::testing::ElementsAre("livez", "readyz", "metrics", "status", "openapi",
                                             "config", "audit", "revocations"));
}

TEST(Scopes, WhatIsOutOfScopeIsAsIfItWereNotThere) {
  World all(true);
  World north(false);
  for (const auto& [name, questions] : Questions()) {
    for (std::size_t i = 0; i < questions.size(); ++i) {
      const std::string& target = questions[i];
      SCOPED_TRACE(target);
      const Response shown = all.Get(target, identity::Scope::Of({"north"}));
      const Response alone = north.Get(target, identity::Scope::Of({"north"}));
      EXPECT_EQ(shown.status, alone.status) << shown.body << shown.cause;
      EXPECT_EQ(shown.content(), alone.content());
      EXPECT_EQ(shown.entity_tag, alone.entity_tag);
      EXPECT_EQ(shown.coding, alone.coding);
      EXPECT_EQ(shown.content_type, alone.content_type);
      // Who may see all fleets is shown more, so there is something to hide.
      const Response everything = all.Get(target, identity::Scope::All());
      const Response less = north.Get(target, identity::Scope::All());
      if (i == 0) {
        EXPECT_NE(everything.content(), less.content());
      }
    }
  }
}

TEST(Scopes, ItsOwnIsShownAsToWhoSeesAll) {
  World north(false);
  for (const auto& [name, questions] : Questions()) {
    if (name == "metrics_robots" || name == "top") continue;
    for (const std::string& target : questions) {
      SCOPED_TRACE(target);
      EXPECT_EQ(north.Get(target, identity::Scope::Of({"north"})).body,
                north.Get(target, identity::Scope::All()).body);
    }
  }
}

TEST(Scopes, AFleetOutOfScopeIsAnsweredAsAnUnknownOne) {
  World all(true);
  for (const auto& [name, questions] : Questions()) {
    const std::string& target = questions.front();
    if (target.find('?') != std::string::npos || !target.starts_with("/api")) continue;
    if (name == "robot") continue;
    SCOPED_TRACE(target);
    const auto body = [&](const std::string& fleet, const identity::Scope& scope) {
      const Response answer = all.Get(target + "?fleet=" + fleet, scope);
      EXPECT_EQ(answer.status, 200) << answer.body;
      return answer.body;
    };
    const identity::Scope scope = identity::Scope::Of({"east", "north"});
    EXPECT_EQ(body("south", scope), body("no-such-fleet", scope));
    EXPECT_EQ(body("south", scope), body("no-such-fleet", identity::Scope::All()));
  }
}

TEST(Scopes, NoFleetSeesNothing) {
  World all(true);
  for (const auto& [name, questions] : Questions()) {
    for (const std::string& target : questions) {
      if (target.find("ruri=") != std::string::npos || name == "robot") continue;
      SCOPED_TRACE(target);
      const Response answer = all.Get(target, identity::Scope::Of({}));
      EXPECT_EQ(answer.status, 200);
      EXPECT_THAT(std::string(answer.content()), Not(HasSubstr("rcan://")));
    }
  }
}

TEST(Scopes, SeveralFleetsAreShownTogether) {
  World all(true);
  const identity::Scope scope = identity::Scope::Of({"east", "north", "south"});
  for (const char* path : {"/api/v1/messages", "/api/v1/robots", "/api/v1/fleets",
                           "/api/v1/connections", "/api/v1/shapes"}) {
    EXPECT_EQ(all.Get(path, scope).body, all.Get(path, identity::Scope::All()).body) << path;
  }
}

// Rows have the fleet that their robot had when they were written.
TEST(Scopes, ARobotThatMovedIsShownToItsNewFleetWithoutWhatItDidInTheOldOne) {
  World all(true);
  ServerWorld& world = all.world();
  ASSERT_TRUE(world.fleet.FindOrAdmit({kSouth, "north"}).ok());
  ASSERT_EQ(world.fleet.Find(kSouth)->id()->fleet, "north");
  world.CommitBody(kSouth, model::Message{1, model::MessageLevel::kInfo, "moved"});
  const auto get = [&](const std::string& target, const std::string& fleet) {
    return all.Get(target + "ruri=" + kSouth, identity::Scope::Of({fleet}));
  };
  EXPECT_EQ(get("/api/v1/robot?", "north").status, 200);
  EXPECT_EQ(get("/api/v1/robot?", "south").status, 404);
  EXPECT_THAT(get("/api/v1/messages?", "north").body, HasSubstr("moved"));
  EXPECT_THAT(get("/api/v1/messages?", "north").body, Not(HasSubstr(R"("message":"rcan://b")")));
  EXPECT_THAT(get("/api/v1/messages?", "south").body, Not(HasSubstr("moved")));
  EXPECT_EQ(get("/api/v1/robot/story?", "south").status, 404);
  const Response story = get("/api/v1/robot/story?", "north");
  EXPECT_EQ(story.status, 200);
  EXPECT_THAT(story.body, HasSubstr(R"("entries":[])"));
}

TEST(Scopes, AStoryWaitsUntilItIsKnownOfWhichFleetARobotIs) {
  World all(true);
  ServerWorld& world = all.world();
  world.robots_unread = true;
  const identity::Scope north = identity::Scope::Of({"north"});
  const std::string story = "/api/v1/robot/story?ruri=";
  EXPECT_EQ(all.Get(story + kNorth, north).status, 200);
  EXPECT_EQ(all.Get(story + kSouth, north).status, 503);
  EXPECT_EQ(all.Get(story + "rcan://x", north).status, 503);
  EXPECT_EQ(all.Get(story + kSouth, identity::Scope::All()).status, 200);
}

TEST(Scopes, WhatQuarantineDroppedIsToldOfOnesOwnRobots) {
  World all(true);
  ServerWorld& world = all.world();
  for (const std::string& ruri : {kNorth, kSouth}) {
    const storage::RobotRef robot = world.fleet.Find(ruri)->id();
    for (std::size_t i = 0; i < storage::kQuarantineRowsPerRobotMax; ++i) {
      world.CommitQuarantine(ruri, {model::RejectReason::kMalformed, "", ""}, "",
                             storage::OriginOf(model::MessageSource::kCyberwave, "t"));
    }
    ASSERT_TRUE(world.store.TrimQuarantine({&ruri, 1}).ok());
  }
  const auto dropped = [&](const std::string& ruri, const identity::Scope& scope) {
    const std::string body = all.Get("/api/v1/quarantine?pageSize=1&ruri=" + ruri, scope).body;
    return body.find(R"("droppedByReason":{})") == std::string::npos;
  };
  EXPECT_TRUE(dropped(kNorth, identity::Scope::Of({"north"})));
  EXPECT_FALSE(dropped(kSouth, identity::Scope::Of({"north"})));
  EXPECT_TRUE(dropped(kSouth, identity::Scope::All()));
}

}  // namespace
}  // namespace uplink::http
