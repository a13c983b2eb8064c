// The list's filters and orders, each with a robot of every source.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/cyberwave/ruri.h"
#include "server/robot/live_bytes.h"
#include "server/view/messages.h"
#include "server/view/queries.h"
#include "tests/support/records.h"
#include "tests/support/server_world.h"
#include "tests/unit/schema/cyberwave/judging.h"
#include "tests/unit/server/uncrew/avatar_bench.h"

namespace uplink::view {
namespace {

using model::uncrew::SampleType;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

const std::string kRover = "rcan://example.org/acme/rover/1.0/Rover-7";
const std::string kArm = "rcan://example.org/acme/arm/2.0/arm-1";
const std::string kDrone = "rcan://local.rcan/uncrew/uav/1";

/// A robot of each source in fleet `f`: by Rover Nexus, by RCAN, behind a broker, and by calls.
class RobotFiltersTest : public ::testing::Test {
 protected:
  RobotFiltersTest() {
    robot::Robot& rover = Admit(kRover);
    Apply(rover, model::MotionTelemetry{.pose = model::Pose{.lat_deg = 47.5, .lon_deg = 8.5}});
    model::StatusTelemetry status;
    status.battery = model::BatteryStatus{.soc_pct = 80.F};
    status.estop = model::EStop{.active = true};
    Apply(rover, status);
    model::RcanState state;
    state.battery_pct = 10;
    // Within any box, if they were degrees.
    state.position = model::RcanPosition{.x_m = 8.5, .y_m = 47.5};
    Admit(kArm).state.Apply(std::move(state), clock_.Steady());
    Admit(twin_ruri_);
    EXPECT_NE(twins_.FindOrAdd(twin_ruri_, twin_), nullptr);
    Publish("gps", R"({"latitude":-17.5,"longitude":179.5})");
    Publish("metrics", R"({"metrics":{"power":{"battery_percent":40}}})");
    Call(SampleType::kBattery, "battery { id: 0 remaining_percent: 25 }");
    Call(SampleType::kPosition, "position { latitude_deg: 47.6 longitude_deg: 8.6 }");
  }

  robot::Robot& Admit(const std::string& ruri) { return **bench_.fleet().FindOrAdmit({ruri, "f"}); }
  robot::Robot& Find(const std::string& ruri) { return *bench_.fleet().Find(ruri); }
  /// Another process holds it.
  robot::Robot& AdmitForeign(const std::string& ruri) {
    robot::Robot& robot = Admit(ruri);
    robot.state.FollowHolder({.held_by = "b:2"}, {model::Presence::kOnline, {}});
    return robot;
  }
  void Apply(robot::Robot& robot, const model::Body& body) {
    std::vector<model::Record> records;
    records.push_back(test::RecordOf(body));
    robot.state.Apply(records, clock_.Steady());
  }
  void Publish(std::string_view tail, std::string_view payload) {
    const cyberwave::Applied applied =
        twins_.Apply(*twins_.Find(twin_ruri_), test::JudgeOn(tail, payload),
                     {.steady = clock_.Steady(), .system = clock_.System()});
    EXPECT_NE(applied.outcome, cyberwave::Outcome::kRejected) << payload;
  }
  void Call(SampleType type, std::string_view text) {
    EXPECT_EQ(bench_.Call(type, text).End(), "APPLIED") << text;
    bench_.Commit();
  }
  /// A connection of it begins.
  static void Connect(robot::Robot& robot, const std::string& version, SystemTime not_after) {
    storage::ConnectionItem item;
    item.agent_version = version;
    item.certificate.not_after = not_after;
    robot.agent.Begin(item);
  }
  RobotsPage Page(const RobotsQuery& query) {
    auto page = queries_.Robots(query);
    EXPECT_TRUE(page.ok()) << page.status();
    return page.ok() ? *std::move(page) : RobotsPage();
  }
  static std::vector<std::string> Ruris(const RobotsPage& page) {
    std::vector<std::string> ruris;
    for (const RobotView& robot : page.robots) ruris.push_back(robot.id.ruri);
    return ruris;
  }
  std::vector<std::string> Found(const RobotsFilter& filter) {
    const RobotsPage page = Page({.filter = filter});
    EXPECT_EQ(page.total, static_cast<std::int64_t>(page.robots.size()));
    return Ruris(page);
  }
  std::vector<std::string> FoundBy(const ValuesFilter& values) { return Found({.values = values}); }
  std::vector<std::string> Ordered(RobotsOrder order, std::uint32_t page_size) {
    RobotsQuery query{.order = order, .page_size = page_size};
    std::vector<std::string> ruris;
    do {
      const RobotsPage page = Page(query);
      EXPECT_EQ(page.total, 4);
      for (const std::string& ruri : Ruris(page)) ruris.push_back(ruri);
      query.page_token = page.next_token;
    } while (!query.page_token.empty() && ruris.size() < 10);
    return ruris;
  }
  v1::Robot Shown(const std::string& ruri) { return ToMessage(*queries_.Robot(ruri, {})); }

  testing::ManualClock clock_;
  testing::FakeDatabase database_;
  uncrew::AvatarBench bench_{clock_, database_, 1};
  cyberwave::Twins twins_{10};
  const model::cyberwave::Uuid twin_ = *model::cyberwave::Uuid::FromText(test::kTwin);
  const std::string twin_ruri_ = cyberwave::TwinRuri("", twin_, cyberwave::RobotKind::kReal);
  testing::ServerWorld world_;
  FaultCounts faults_{clock_};
  Queries queries_{{.clock = clock_,
                    .fleet = bench_.fleet(),
                    .reader = world_.reader,
                    .journals = world_.shards,
                    .ledgers = world_.ledgers,
                    .streams = world_.sessions.streams,
                    .version = "9.9.9",
                    .twins = &twins_,
                    .drones = &bench_.drones(),
                    .faults = &faults_}};
};

TEST_F(RobotFiltersTest, ARobotOfEachSourceShowsItsVitals) {
  const v1::Robot rover = Shown(kRover);
  EXPECT_EQ(rover.position().frame(), "wgs84");
  EXPECT_EQ(rover.position().latitude(), 47.5);
  EXPECT_FALSE(rover.position().has_x());
  EXPECT_EQ(rover.battery_percent(), 80);
  EXPECT_TRUE(rover.has_estop() && rover.estop());
  const v1::Robot arm = Shown(kArm);
  EXPECT_EQ(arm.position().frame(), "local");
  EXPECT_EQ(arm.position().x(), 8.5);
  EXPECT_FALSE(arm.position().has_latitude());
  EXPECT_EQ(arm.battery_percent(), 10);
  EXPECT_FALSE(arm.has_estop());
  const v1::Robot twin = Shown(twin_ruri_);
  EXPECT_EQ(twin.position().longitude(), 179.5);
  EXPECT_EQ(twin.battery_percent(), 40);
  const v1::Robot drone = Shown(kDrone);
  EXPECT_EQ(drone.position().latitude(), 47.6);
  EXPECT_EQ(drone.battery_percent(), 25);
}

TEST_F(RobotFiltersTest, ByBatteryBelow) {
  EXPECT_THAT(FoundBy({.battery_below = 10}), IsEmpty());
  EXPECT_THAT(FoundBy({.battery_below = 10.5}), ElementsAre(kArm));
  EXPECT_THAT(FoundBy({.battery_below = 41}), UnorderedElementsAre(kArm, twin_ruri_, kDrone));
  EXPECT_THAT(FoundBy({.battery_below = 100}),
              UnorderedElementsAre(kArm, twin_ruri_, kDrone, kRover));
  Admit("rcan://silent");
  EXPECT_EQ(FoundBy({.battery_below = 100}).size(), 4U) << "an unknown battery is not low";
}

TEST_F(RobotFiltersTest, ByBoxAndLocalPositionsNeverMatch) {
  const BoundingBox zurich{.west = 8, .south = 47, .east = 9, .north = 48};
  EXPECT_THAT(FoundBy({.bbox = zurich}), UnorderedElementsAre(kRover, kDrone));
  EXPECT_THAT(FoundBy({.bbox = BoundingBox{8.5, 47.5, 8.5, 47.5}}), ElementsAre(kRover)) << "edges";
  EXPECT_THAT(FoundBy({.bbox = BoundingBox{-180, -90, 180, 90}}),
              UnorderedElementsAre(kRover, kDrone, twin_ruri_));
  EXPECT_THAT(FoundBy({.bbox = BoundingBox{179, -20, -179, -10}}), ElementsAre(twin_ruri_));
}

TEST_F(RobotFiltersTest, ByEstopAndOneThatNeverToldItMatchesNeither) {
  EXPECT_THAT(FoundBy({.estop = true}), ElementsAre(kRover));
  EXPECT_THAT(FoundBy({.estop = false}), IsEmpty());
  model::StatusTelemetry released;
  released.estop = model::EStop{.active = false};
  Apply(Find(kDrone), released);
  EXPECT_THAT(FoundBy({.estop = false}), ElementsAre(kDrone)) << "a drone that also has a stream";
}

TEST_F(RobotFiltersTest, ByFaultsOfAnySource) {
  EXPECT_THAT(FoundBy({.faulted = true}), IsEmpty());
  EXPECT_EQ(FoundBy({.faulted = false}).size(), 4U);
  model::StatusTelemetry faulted;
  faulted.faulted = true;
  Apply(Find(kArm), faulted);
  EXPECT_THAT(FoundBy({.faulted = true}), ElementsAre(kArm));
  model::Fault fault{.unix_time_ms = 1, .fault_id = "f", .source = "s", .active = true};
  std::vector<std::string> with_faults = {kArm};
  for (const std::string& ruri : {kRover, twin_ruri_, kDrone}) {
    world_.AddRobot(ruri, "f");
    world_.CommitFault(ruri, fault);
    with_faults.push_back(ruri);
    clock_.Advance(kFaultCountsFresh);
    EXPECT_EQ(FoundBy({.faulted = true}).size(), with_faults.size()) << ruri;
  }
  EXPECT_THAT(FoundBy({.faulted = true}), ::testing::UnorderedElementsAreArray(with_faults));
  world_.reader.SetAway(true);
  clock_.Advance(kFaultCountsAgeMax + milliseconds(1));
  EXPECT_TRUE(
      absl::IsUnavailable(queries_.Robots({.filter = {.values = {.faulted = true}}}).status()));
}

TEST_F(RobotFiltersTest, BySoftwareOfTheAgentOrTheRobot) {
  for (const std::string& ruri : {kRover, kArm, twin_ruri_, kDrone}) {
    robot::Robot& robot = Find(ruri);
    Connect(robot, "agent-of-" + robot.ruri(), SystemTime());
    robot.state.KeepReport(model::AgentInfo{.agent_version = "a", .software_version = robot.ruri()},
                           clock_.System());
    EXPECT_THAT(FoundBy({.software = "agent-of-" + ruri}), ElementsAre(ruri));
    EXPECT_THAT(FoundBy({.software = ruri}), ElementsAre(ruri));
    EXPECT_EQ(Shown(ruri).agent_version(), "agent-of-" + ruri);
  }
  EXPECT_THAT(FoundBy({.software = "agent"}), IsEmpty()) << "a version is whole";
}

TEST_F(RobotFiltersTest, ByCertificatesOfConnectionsThatAreOpen) {
  const SystemTime soon = clock_.System() + std::chrono::hours(24);
  for (const std::string& ruri : {kRover, kArm, twin_ruri_, kDrone}) {
    Connect(Find(ruri), "1", soon);
    EXPECT_EQ(Shown(ruri).certificate_not_after().seconds(), UnixMs(soon) / 1000);
    EXPECT_EQ(Shown(ruri).certificate_days_left(), 1);
  }
  EXPECT_THAT(FoundBy({.certificate_expires_before = soon}), IsEmpty());
  const SystemTime later = soon + milliseconds(1);
  EXPECT_EQ(FoundBy({.certificate_expires_before = later}).size(), 4U);
  Find(kArm).agent.End({});
  EXPECT_EQ(FoundBy({.certificate_expires_before = later}).size(), 3U);
  EXPECT_EQ(Shown(kArm).agent_version(), "1") << "the last one that is known";
  EXPECT_FALSE(Shown(kArm).has_certificate_days_left());
  clock_.Advance(std::chrono::hours(25));
  EXPECT_EQ(Shown(kRover).certificate_days_left(), -1) << "it has expired";
}

TEST_F(RobotFiltersTest, ByWhatIsHeldBack) {
  for (const std::string& ruri : {kRover, kArm, twin_ruri_, kDrone}) {
    robot::Robot& robot = Find(ruri);
    robot.sessions.SetHeldBack(robot::HeldBack::kFlow, clock_.System());
    EXPECT_THAT(FoundBy({.held_back = true}), ElementsAre(ruri));
    EXPECT_EQ(FoundBy({.held_back = false}).size(), 3U);
    robot.sessions.SetHeldBack(robot::HeldBack::kNone, clock_.System());
  }
}

TEST_F(RobotFiltersTest, ByAPartOfTheLastTwoSegmentsInAnyCase) {
  EXPECT_THAT(Found({.q = "rover-7"}), ElementsAre(kRover));
  EXPECT_THAT(Found({.q = "2.0/ARM"}), ElementsAre(kArm));
  EXPECT_THAT(Found({.q = "uav/1"}), ElementsAre(kDrone));
  EXPECT_THAT(Found({.q = std::string(test::kTwin.substr(0, 8))}), ElementsAre(twin_ruri_));
  EXPECT_THAT(Found({.q = "acme"}), IsEmpty()) << "a segment before the last two";
}

TEST_F(RobotFiltersTest, ByOfflineSince) {
  for (const std::string& ruri : {kRover, kArm, twin_ruri_, kDrone}) {
    robot::Robot& robot = Find(ruri);
    robot.state.SignOfLife(clock_.Steady(), clock_.System(), {});
  }
  clock_.Advance(std::chrono::hours(1));
  bench_.fleet().Sweep(std::chrono::hours(9));
  const SystemTime since = Find(kArm).state.presence_since();
  EXPECT_THAT(Found({.offline_before = since}), IsEmpty());
  EXPECT_EQ(Found({.offline_before = since + milliseconds(1)}).size(), 4U);
  Find(kArm).state.SignOfLife(clock_.Steady(), clock_.System(), {});
  EXPECT_EQ(Found({.offline_before = since + milliseconds(1)}).size(), 3U);
}

TEST_F(RobotFiltersTest, FiltersAddUp) {
  const BoundingBox zurich{.west = 8, .south = 47, .east = 9, .north = 48};
  EXPECT_THAT(Found({.fleets = {"f"}, .values = {.battery_below = 50, .bbox = zurich}}),
              ElementsAre(kDrone));
  EXPECT_THAT(Found({.fleets = {"g"}, .values = {.battery_below = 50}}), IsEmpty());
}

TEST_F(RobotFiltersTest, EachOrderGoesBothWaysPageByPage) {
  const std::vector<std::string> by_battery = {kArm, kDrone, twin_ruri_, kRover};
  std::vector<std::string> down(by_battery.rbegin(), by_battery.rend());
  for (const std::uint32_t size : {1U, 3U, 100U}) {
    EXPECT_EQ(Ordered({.by = RobotsBy::kBattery}, size), by_battery) << size;
    EXPECT_EQ(Ordered({.by = RobotsBy::kBattery, .descending = true}, size), down) << size;
    std::vector<std::string> by_ruri = Ordered({}, size);
    EXPECT_TRUE(std::ranges::is_sorted(by_ruri));
    std::ranges::reverse(by_ruri);
    EXPECT_EQ(Ordered({.by = RobotsBy::kRuri, .descending = true}, size), by_ruri);
  }
  for (const std::string& ruri : {kRover, kArm}) {
    Find(ruri).state.SignOfLife(clock_.Steady(), clock_.System(), {});
    clock_.Advance(milliseconds(1));
  }
  Find(kDrone).state.NoteBatch({.backlog_uplinks = 7}, clock_.Steady(), clock_.System());
  const auto heard = Ordered({.by = RobotsBy::kLastHeard, .descending = true}, 1);
  EXPECT_THAT(heard, ::testing::Contains(kArm));
  EXPECT_LT(std::ranges::find(heard, kArm), std::ranges::find(heard, kRover));
  EXPECT_EQ(Ordered({.by = RobotsBy::kBacklog}, 1).front(), kDrone);
  EXPECT_EQ(Ordered({.by = RobotsBy::kBacklog, .descending = true}, 1).front(), kDrone)
      << "robots without the value come last either way";
}

TEST_F(RobotFiltersTest, ATokenIsOfOneOrder) {
  const RobotsPage page = Page({.order = {.by = RobotsBy::kBattery}, .page_size = 1});
  for (const RobotsOrder order : {RobotsOrder(), RobotsOrder{.by = RobotsBy::kBacklog},
                                  RobotsOrder{.by = RobotsBy::kBattery, .descending = true}}) {
    const auto other = queries_.Robots({.order = order, .page_token = page.next_token});
    EXPECT_TRUE(absl::IsInvalidArgument(other.status())) << other.status();
  }
}

TEST_F(RobotFiltersTest, OthersRobotsAreJudgedByWhatTheStoreHasOrCountAsUnjudged) {
  robot::Robot& other = world_.AddRobot("rcan://other", "f");
  const storage::OpenRequest open{.robot = other.id(), .at = clock_.System()};
  const auto opened = world_.store.OpenStreams({&open, 1});
  robot::LiveChanges changes;
  changes.changed.set(static_cast<std::size_t>(storage::LivePart::kStatus));
  changes.parts.status = model::StatusTelemetry();
  changes.parts.status->battery = model::BatteryStatus{.soc_pct = 5.F};
  storage::LiveRow row = robot::ToRow("rcan://other", changes);
  row.held_since = opened->front().held_since;
  ASSERT_TRUE(world_.store.Checkpoint({&row, 1}).ok());
  AdmitForeign("rcan://other");

  world_.reader.SetAway(true);
  RobotsQuery query{.filter = {.values = {.battery_below = 20}}};
  const RobotsPage unread = Page(query);
  EXPECT_THAT(Ruris(unread), ElementsAre(kArm));
  EXPECT_EQ(unread.unjudged, 1);
  world_.reader.SetAway(false);
  const RobotsPage read = Page(query);
  EXPECT_THAT(Ruris(read), UnorderedElementsAre(kArm, "rcan://other"));
  EXPECT_EQ(read.unjudged, 0);
  EXPECT_EQ(Shown("rcan://other").battery_percent(), 5);
  query.filter.values.held_back = false;
  EXPECT_EQ(Page(query).unjudged, 1) << "its stream is not here";
}

/// Each condition alone. A robot that told nothing meets none of them.
std::vector<ValuesFilter> EachCondition() {
  return {{.battery_below = 100},
          {.bbox = BoundingBox{-180, -90, 180, 90}},
          {.software = "1"},
          {.held_back = true},
          {.estop = false},
          {.faulted = true},
          {.certificate_expires_before = FromUnixMs(std::int64_t{1} << 42)}};
}

TEST_F(RobotFiltersTest, EachConditionIsLookedAt) {
  Admit("rcan://silent");
  for (const ValuesFilter& values : EachCondition()) {
    const RobotsPage page = Page({.filter = {.q = "silent", .values = values}});
    EXPECT_EQ(page.total + page.unjudged, 0);
  }
}

TEST_F(RobotFiltersTest, OthersTwinsAndDronesAreUnjudgedWhereTheStoreLacksTheirValues) {
  const auto uuid = *model::cyberwave::Uuid::FromText("00000000-0000-4000-8000-000000000009");
  AdmitForeign(cyberwave::TwinRuri("", uuid, cyberwave::RobotKind::kReal));
  AdmitForeign("rcan://local.rcan/uncrew/uav/9");
  for (const ValuesFilter& values : EachCondition()) {
    const RobotsPage page = Page({.filter = {.q = "9", .values = values}});
    EXPECT_EQ(page.total, 0);
    // All active faults are in the store.
    EXPECT_EQ(page.unjudged, values.faulted ? 0 : 2);
  }
  ValuesFilter faultless{.faulted = false};
  EXPECT_EQ(Page({.filter = {.q = "9", .values = faultless}}).total, 2);
  faultless.battery_below = 100;
  EXPECT_EQ(Page({.filter = {.q = "9", .values = faultless}}).unjudged, 2);
  faultless.faulted = true;
  EXPECT_EQ(Page({.filter = {.q = "9", .values = faultless}}).unjudged, 0) << "it cannot match";
}

TEST_F(RobotFiltersTest, OthersRobotsShowWhatTheySpeakBy) {
  AdmitForeign("rcan://local.rcan/uncrew/uav/9");
  EXPECT_EQ(Shown("rcan://local.rcan/uncrew/uav/9").source(), "uncrew");
  AdmitForeign("rcan://streams").sessions.Restore({testing::ServerWorld::session(), 1});
  EXPECT_EQ(Shown("rcan://streams").source(), "uplink");
  Find("rcan://streams").calls.NoteSpoken();
  EXPECT_EQ(Shown("rcan://streams").source(), "uplink,uncrew");
  Find(twin_ruri_).state.FollowHolder({.held_by = "b:2"}, {model::Presence::kOnline, {}});
  EXPECT_EQ(Shown(twin_ruri_).source(), "cyberwave");
}

TEST_F(RobotFiltersTest, OthersRobotsShowTheirAgentsWhateverWasAskedBefore) {
  const auto versions = [this] {
    std::vector<std::string> found;
    for (const RobotView& robot : Page({.filter = {.q = "other"}, .parts = {}}).robots) {
      found.push_back(ToMessage(robot).agent_version());
    }
    return found;
  };
  for (const char* ruri : {"rcan://other-1", "rcan://other-2"}) {
    world_.AddRobot(ruri, "f");
    world_.CommitBody(ruri, model::AgentInfo{.agent_version = "1"});
    AdmitForeign(ruri);
  }
  const int before = world_.reader.calls();
  EXPECT_THAT(versions(), ElementsAre("1", "1"));
  EXPECT_EQ(world_.reader.calls(), before + 4) << "faults, requests, live parts, agents: once each";
  EXPECT_EQ(FoundBy({.software = "1"}).size(), 2U);
  world_.CommitBody("rcan://other-1", model::AgentInfo{.agent_version = "2"});
  EXPECT_THAT(versions(), ElementsAre("2", "1")) << "the filter's look is older";
  world_.reader.SetAway(true);
  EXPECT_THAT(versions(), ElementsAre("1", "1")) << "as last read";
}

TEST_F(RobotFiltersTest, OthersRobotsAreWalkedInAnyOrderWithTheirLargeParts) {
  robot::LiveChanges changes;
  for (const storage::LivePart part : {storage::LivePart::kStatus, storage::LivePart::kExtras}) {
    changes.changed.set(static_cast<std::size_t>(part));
  }
  for (int i = 0; i < 1000; ++i) changes.parts.extras.Put(std::to_string(i), {.value = true});
  constexpr std::size_t kRobots = 70;
  ASSERT_GT(kRobots * KeyedBytes(changes.parts), storage::kPageBytesMax);
  testing::ServerWorld world(100);
  for (std::size_t i = 0; i < kRobots; ++i) {
    const std::string ruri = fmt::format("rcan://{:02}", i);
    robot::Robot& robot = world.AddRobot(ruri);
    const storage::OpenRequest open{.robot = robot.id(), .at = world.clock.System()};
    const auto opened = world.store.OpenStreams({&open, 1});
    changes.parts.status = model::StatusTelemetry();
    changes.parts.status->battery =
        model::BatteryStatus{.soc_pct = static_cast<float>(kRobots - i)};
    storage::LiveRow row = robot::ToRow(ruri, changes);
    row.held_since = opened->front().held_since;
    ASSERT_TRUE(world.store.Checkpoint({&row, 1}).ok());
    robot.state.FollowHolder({.held_by = "b:2"}, {model::Presence::kOnline, {}});
  }
  RobotsQuery query{.order = {.by = RobotsBy::kBattery}, .page_size = storage::kPageSizeMax};
  query.parts.Add(Part::kExtras);
  std::vector<double> batteries;
  do {
    const auto page = world.queries.Robots(query);
    ASSERT_TRUE(page.ok() && !page->robots.empty());
    for (const RobotView& robot : page->robots) {
      batteries.push_back(robot.glance.vitals.battery_percent.value_or(-1));
      EXPECT_EQ(robot.state.parts.extras.items().size(), 1000U) << robot.id.ruri;
    }
    query.page_token = page->next_token;
  } while (!query.page_token.empty() && batteries.size() <= kRobots);
  EXPECT_EQ(batteries.size(), kRobots);
  EXPECT_TRUE(std::ranges::is_sorted(batteries));
}

TEST_F(RobotFiltersTest, ARobotThatLeftAndOneThatCameAreSeenAtOnce) {
  EXPECT_EQ(Page({}).total, 4);
  Admit("rcan://new");
  EXPECT_EQ(Page({}).total, 5);
}

}  // namespace
}  // namespace uplink::view
