// Twins that are heard at a broker, among the robots.
#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/cyberwave/ruri.h"
#include "server/view/messages.h"
#include "server/view/queries.h"
#include "tests/support/server_world.h"
#include "tests/unit/schema/cyberwave/judging.h"

namespace uplink::view {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class TwinQueriesTest : public ::testing::Test {
 protected:
  /// Admits the robot of a twin; the others are named after their number.
  robot::Robot& AddTwinRobot(std::size_t number = 0) {
    const std::string ruri = RuriOf(number);
    EXPECT_NE(twins_.FindOrAdd(ruri, twin_), nullptr);
    return **fleet_.FindOrAdmit({ruri, "default"});
  }
  std::string RuriOf(std::size_t number) const {
    const std::string prefix = number == 0 ? "" : std::to_string(number);
    return cyberwave::TwinRuri(prefix, twin_, cyberwave::RobotKind::kReal);
  }
  void Publish(std::string_view tail, std::string_view payload, std::size_t number = 0) {
    const cyberwave::Applied applied =
        twins_.Apply(*twins_.Find(RuriOf(number)), test::JudgeOn(tail, payload),
                     {.steady = world_.clock.Steady(), .system = world_.clock.System()});
    EXPECT_EQ(applied.outcome, cyberwave::Outcome::kApplied) << payload;
  }
  static PartSet Cyberwave() {
    PartSet parts;
    parts.Add(Part::kCyberwave);
    return parts;
  }
  RobotsPage Robots(const RobotsQuery& query) {
    auto page = queries_.Robots(query);
    EXPECT_TRUE(page.ok()) << page.status();
    return page.ok() ? *std::move(page) : RobotsPage();
  }

  testing::ServerWorld world_;
  fleet::Fleet fleet_{world_.clock, 100, {}};
  cyberwave::Twins twins_{100};
  const model::cyberwave::Uuid twin_ = *model::cyberwave::Uuid::FromText(test::kTwin);
  Queries queries_{{.clock = world_.clock,
                    .fleet = fleet_,
                    .reader = world_.reader,
                    .journals = world_.shards,
                    .ledgers = world_.ledgers,
                    .streams = world_.sessions.streams,
                    .version = "9.9.9",
                    .twins = &twins_}};
};

TEST_F(TwinQueriesTest, ARobotShowsWhatItsTwinSaidAndByWhichWayItCame) {
  AddTwinRobot();
  Publish("position", R"({"position":{"x":1,"y":2,"z":3}})");
  const auto robot = queries_.Robot(RuriOf(0), {});
  ASSERT_TRUE(robot.ok()) << robot.status();
  EXPECT_EQ(ToMessage(*robot).source(), "cyberwave");
  EXPECT_THAT(TextsOf(*robot, PartSet::All()).text(),
              HasSubstr(R"("cyberwave":{"position":{"x":1E0,"y":2E0,"z":3E0)"));

  fleet_.FindOrAdmit({"rcan://a", "default"}).IgnoreError();
  const auto other = queries_.Robot("rcan://a", {});
  EXPECT_EQ(ToMessage(*other).source(), "uplink");
  EXPECT_EQ(TextsOf(*other, PartSet::All()).text(), "");
}

TEST_F(TwinQueriesTest, WhatWasShownIsNotWhatIsSaidLater) {
  AddTwinRobot();
  Publish("position", R"({"position":{"x":1,"y":2,"z":3}})");
  const auto robot = queries_.Robot(RuriOf(0), {});
  Publish("position", R"({"position":{"x":7,"y":7,"z":7}})");
  EXPECT_EQ(robot->twin->position->value.x_m, 1);
}

TEST_F(TwinQueriesTest, AListCarriesItWhereItIsWanted) {
  EXPECT_EQ(PartFromText("cyberwave"), Part::kCyberwave);
  EXPECT_FALSE(Cyberwave().AnyStored());
  EXPECT_FALSE(Cyberwave().AnyLive());
  EXPECT_TRUE(PartSet::All().AnyStored() && PartSet::All().AnyLive());
  AddTwinRobot();
  Publish("position", R"({"position":{"x":1,"y":2,"z":3}})");
  const RobotsPage without = Robots({});
  EXPECT_EQ(without.robots.at(0).twin, nullptr);
  EXPECT_EQ(ToMessage(without.robots.at(0)).source(), "cyberwave");
  const RobotsPage with = Robots({.parts = Cyberwave()});
  ASSERT_NE(with.robots.at(0).twin, nullptr);
  EXPECT_THAT(TextsOf(with.robots.at(0), Cyberwave()).text(), HasSubstr("\"cyberwave\":{"));
  EXPECT_EQ(TextsOf(with.robots.at(0), PartSet::OfLists()).text(), "");
}

TEST_F(TwinQueriesTest, AListOfLargeTwinsEndsItsPagesEarly) {
  constexpr std::size_t kTwins = 80;
  const std::string data = R"("data":{"x":")" + std::string(60'000, 'x') + "\"}}";
  for (std::size_t i = 0; i < kTwins; ++i) {
    AddTwinRobot(i);
    for (std::size_t report = 0; report < 8; ++report) {
      Publish("telemetry", R"({"telemetry_type":"r)" + std::to_string(report) + "\"," + data, i);
    }
  }
  const std::size_t each = twins_.bytes() / kTwins;
  ASSERT_GT(kTwins * each, 2 * storage::kPageBytesMax);
  EXPECT_THAT(Robots({.page_size = 100}).robots, SizeIs(kTwins));
  RobotsQuery query{.page_size = 100, .parts = Cyberwave()};
  std::vector<std::string> listed;
  do {
    const RobotsPage page = Robots(query);
    EXPECT_EQ(page.total, kTwins);
    EXPECT_LT(page.robots.size() * each, storage::kPageBytesMax + 2 * each);
    for (const RobotView& robot : page.robots) listed.push_back(robot.id.ruri);
    query.page_token = page.next_token;
    ASSERT_LE(listed.size(), kTwins);
  } while (!query.page_token.empty());
  EXPECT_EQ(std::set<std::string>(listed.begin(), listed.end()).size(), kTwins);
  EXPECT_THAT(listed, SizeIs(kTwins));
}

TEST_F(TwinQueriesTest, WhoDoesNotHoldARobotShowsNothingOfItsTwin) {
  robot::Robot& robot = AddTwinRobot();
  Publish("position", R"({"position":{"x":1,"y":2,"z":3}})");
  robot.state.FollowHolder({.held_by = "b:2", .written_at = FromUnixMs(8)},
                           {model::Presence::kOnline, FromUnixMs(6)});
  EXPECT_EQ(queries_.Robot(RuriOf(0), {})->twin, nullptr);
  EXPECT_EQ(Robots({.parts = Cyberwave()}).robots.at(0).twin, nullptr);
}

TEST_F(TwinQueriesTest, StatusAsksWhatIsDoneAtTheBrokerEachTime) {
  EXPECT_FALSE(queries_.Status().broker);
  std::optional<BrokerStatus> broker = BrokerStatus{.twins = 1};
  const Queries queries({.clock = world_.clock,
                         .fleet = fleet_,
                         .reader = world_.reader,
                         .journals = world_.shards,
                         .ledgers = world_.ledgers,
                         .streams = world_.sessions.streams,
                         .version = "9.9.9",
                         .broker = [&broker] { return broker; }});
  EXPECT_EQ(queries.Status().broker->twins, 1U);
  broker->twins = 2;
  EXPECT_EQ(queries.Status().broker->twins, 2U);
  broker.reset();
  EXPECT_FALSE(queries.Status().broker);
}

TEST_F(TwinQueriesTest, WhatStandsForNoRobotIsNone) {
  const std::string nobody = storage::NoRobotOf("");
  fleet_.FindOrAdmit({nobody, "default"}).IgnoreError();
  EXPECT_THAT(Robots({}).robots, IsEmpty());
  EXPECT_EQ(Robots({}).total, 0);
  EXPECT_EQ(queries_.Robot(nobody, {}).status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(queries_.Status().robots.unknown, 0);
}

}  // namespace
}  // namespace uplink::view
