// Who has room in a scrape that is too small for all: robots that a gateway invents hide no others.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/rcan/scrape.h"
#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"
#include "tests/unit/schema/cyberwave/judging.h"

namespace uplink::rcan {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr const char* kFleet = "north";
/// What a robot is, whether it is online, and when it was last heard.
constexpr std::size_t kBasic = 3;
/// As many joints with one series each as rcan.robot_series_max leaves room for.
constexpr std::size_t kLarge = 512 - kBasic;

class SilentInbox final : public loop::WakeInbox {
 public:
  void Wake(std::uint64_t /*stream*/) override {}
};

class SharedRoomTest : public ::testing::Test {
 protected:
  /// A robot that streams through a gateway, or by itself if that is empty.
  robot::Robot& Robot(const std::string& ruri, const std::string& gateway = "",
                      const std::string& fleet = kFleet) {
    robot::Robot& robot = **fleet_.FindOrAdmit({ruri, fleet});
    stream_ = {.inbox = &inbox_, .stream = stream_.stream + 1};
    static_cast<void>(
        robot.sessions.Attach(stream_, clock_.Steady(), clock_.System(), {.gateway = gateway}));
    robot.state.SignOfLife(clock_.Steady(), clock_.System(), {});
    return robot;
  }
  void SayJoints(robot::Robot& robot, std::size_t count) {
    model::RcanState state;
    for (std::size_t i = 0; i < count; ++i) {
      state.joints.push_back(
          {.joint = "j" + std::to_string(i), .position_rad = 1, .timestamp_us = 1});
    }
    robot.state.Apply(std::move(state), clock_.Steady());
  }
  /// Robots whose names sort before all others.
  void Invent(int robots, std::size_t joints, const std::string& gateway) {
    for (int i = 0; i < robots; ++i) {
      SayJoints(Robot(fmt::format("rcan://a/{:04}", i), gateway), joints);
    }
  }
  RobotScrape& Scrape() {
    if (!scrape_) {
      scrape_.emplace(
          RobotScrape::Sources{clock_, fleet_, config_, faults_, probe_, logger_, {}, &twins_});
    }
    return *scrape_;
  }
  void NewScrape(const std::vector<std::string>& fleets = {}) {
    clock_.Advance(kTextShared);
    text_ = *Scrape().Text(metrics::Format::kText, metrics::Coding::kPlain, kTextsMax, fleets);
  }
  /// Of the last scrape.
  [[nodiscard]] std::size_t SeriesOf(const std::string& ruri) const {
    std::size_t count = 0;
    const std::string label = "ruri=\"" + ruri + "\"}";
    for (std::size_t at = 0; (at = text_.find(label, at)) != std::string::npos; ++at) ++count;
    return count;
  }

  testing::ManualClock clock_;
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                      log::Level::kInfo};
  fleet::Fleet fleet_{clock_, 2000, {}};
  config::RcanConfig config_;
  view::FaultCounts faults_{clock_};
  cyberwave::Twins twins_{10};
  RcanProbe probe_;
  SilentInbox inbox_;
  loop::StreamRef stream_;
  std::optional<RobotScrape> scrape_;
  std::string text_;
};

TEST_F(SharedRoomTest, A1190LargeTablesOfAGatewayHideTheirOwnSeriesAlone) {
  ASSERT_EQ(config_.series_max, 600'000U);
  Invent(1190, kLarge, "g");
  // By their names, 1,171 large ones and this one take all room to the last series.
  static_assert(1171 * 512 + kBasic + 445 == 600'000);
  SayJoints(**fleet_.FindOrAdmit({"rcan://a/1171", kFleet}), 445);
  SayJoints(Robot("rcan://z/itself"), 3);
  SayJoints(Robot("rcan://z/other-gateway", "h"), 3);
  SayJoints(Robot("rcan://z/other-fleet", "", "south"), 3);
  NewScrape();
  for (const char* honest : {"rcan://z/itself", "rcan://z/other-gateway", "rcan://z/other-fleet"}) {
    EXPECT_EQ(SeriesOf(honest), kBasic + 3) << honest;
  }
  EXPECT_EQ(SeriesOf("rcan://a/0000"), 512U) << "what has room stays";
  EXPECT_EQ(SeriesOf("rcan://a/1189"), kBasic) << "and the basic series of all";
  EXPECT_LE(probe_.series.value(), 600'000);
  EXPECT_GT(probe_.series.value(), 600'000 - static_cast<std::int64_t>(kLarge));
  EXPECT_EQ(probe_.robots_left_out.value(), 0);
}

TEST_F(SharedRoomTest, AtTheBoundAllHaveRoomAndOneSeriesPastItOneRobotHasNot) {
  config_.series_max = 2 * (kBasic + 10);
  Invent(1, 10, "g");
  robot::Robot& honest = Robot("rcan://z");
  SayJoints(honest, 10);
  NewScrape();
  EXPECT_EQ(probe_.series.value(), 26);
  EXPECT_EQ(probe_.robots_incomplete.value(), 0);
  EXPECT_FALSE(Scrape().full());
  EXPECT_THAT(lines_, IsEmpty());
  SayJoints(honest, 11);
  NewScrape();
  EXPECT_EQ(SeriesOf("rcan://a/0000"), 13U);
  EXPECT_EQ(SeriesOf("rcan://z"), kBasic) << "all with a word of its own, or none";
  EXPECT_EQ(probe_.robots_incomplete.value(), 1);
  EXPECT_EQ(probe_.robots_left_out.value(), 0);
  EXPECT_EQ(probe_.series_no_room_total.value(), 11);
  EXPECT_TRUE(Scrape().full());
}

TEST_F(SharedRoomTest, WhoWantsMostIsNamedOnceAMinute) {
  config_.series_max = 1000;
  Invent(3, kLarge, "CN=hall,OU=gateway,O=north");
  SayJoints(Robot("rcan://z"), 3);
  for (int i = 0; i < 3; ++i) NewScrape();
  EXPECT_EQ(SeriesOf("rcan://z"), kBasic + 3);
  ASSERT_THAT(lines_, SizeIs(1));
  EXPECT_THAT(lines_.front(),
              AllOf(HasSubstr("warn rcan_robots_left_out robots=0 series_max=1000 "
                              "robots_basic_alone=2 most_fleet=north most_way=gateway "),
                    HasSubstr("CN=hall,OU=gateway,O=north"),
                    HasSubstr(" most_series=518 most_left_out=1018")));
  clock_.Advance(std::chrono::minutes(1));
  NewScrape();
  EXPECT_THAT(lines_, SizeIs(2));
}

TEST_F(SharedRoomTest, IsFullUntilItHasRoomAgainOrNobodyScrapes) {
  config_.series_max = 600;
  Invent(2, kLarge, "g");
  EXPECT_FALSE(Scrape().full()) << "no scrape yet";
  NewScrape();
  EXPECT_TRUE(Scrape().full());
  clock_.Advance(kScrapedWithin - std::chrono::milliseconds(1));
  EXPECT_TRUE(Scrape().full());
  clock_.Advance(std::chrono::milliseconds(1));
  EXPECT_FALSE(Scrape().full());
}

TEST_F(SharedRoomTest, ALackOfRoomIsNotHiddenByAScrapeOfOtherFleets) {
  config_.series_max = 600;
  Invent(2, kLarge, "g");
  SayJoints(Robot("rcan://z", "", "south"), 3);
  NewScrape();
  const std::int64_t series = probe_.series.value();
  EXPECT_TRUE(Scrape().full());
  for (int i = 0; i < 2; ++i) {
    NewScrape({"south"});
    EXPECT_EQ(SeriesOf("rcan://z"), kBasic + 3);
    EXPECT_EQ(SeriesOf("rcan://a/0000"), 0U);
    EXPECT_TRUE(Scrape().full());
    EXPECT_EQ(probe_.series.value(), series);
    EXPECT_EQ(probe_.robots_incomplete.value(), 1);
  }
  clock_.Advance(kScrapedWithin - kTextShared);
  NewScrape({"south"});
  EXPECT_FALSE(Scrape().full()) << "the others are not scraped any more";
  EXPECT_EQ(probe_.series.value(), static_cast<std::int64_t>(kBasic + 3));
  EXPECT_EQ(probe_.robots_incomplete.value(), 0);
}

TEST_F(SharedRoomTest, AScopeHasTheRoomOfAScrapeToItself) {
  config_.series_max = kLarge + kBasic;
  Invent(4, kLarge, "g");
  SayJoints(Robot("rcan://z", "", "south"), kLarge);
  NewScrape({"east", "south"});
  EXPECT_EQ(SeriesOf("rcan://z"), kLarge + kBasic);
  EXPECT_FALSE(Scrape().full());
}

TEST_F(SharedRoomTest, ItsRobotsAreStillTheGatewaysOnceTheirStreamsHaveEnded) {
  config_.series_max = 3000;
  for (int i = 0; i < 10; ++i) {
    robot::Robot& robot = Robot(fmt::format("rcan://a/{:04}", i), "g");
    SayJoints(robot, kLarge);
    static_cast<void>(robot.sessions.Detach(stream_, clock_.Steady()));
  }
  // By themselves, and more than the share of a third.
  for (int i = 0; i < 4; ++i) SayJoints(Robot("rcan://z/" + std::to_string(i)), 300);
  NewScrape();
  for (int i = 0; i < 4; ++i) EXPECT_EQ(SeriesOf("rcan://z/" + std::to_string(i)), kBasic + 300);
}

TEST_F(SharedRoomTest, RobotsOfWhichNoStreamCameHereTakeNothingFromOthers) {
  config_.series_max = 3000;
  for (int i = 0; i < 10; ++i) {
    robot::Robot& robot = **fleet_.FindOrAdmit({fmt::format("rcan://a/{:04}", i), kFleet});
    robot.state.SignOfLife(clock_.Steady(), clock_.System(), {});
    SayJoints(robot, kLarge);
  }
  for (int i = 0; i < 4; ++i) SayJoints(Robot("rcan://z/" + std::to_string(i)), 300);
  NewScrape();
  for (int i = 0; i < 4; ++i) EXPECT_EQ(SeriesOf("rcan://z/" + std::to_string(i)), kBasic + 300);
}

TEST_F(SharedRoomTest, BasicSeriesHaveTurnsTooWhereNotEvenTheyFit) {
  config_.series_max = 150;
  Invent(200, kLarge, "g");
  for (int i = 0; i < 10; ++i) SayJoints(Robot("rcan://z/" + std::to_string(i)), 3);
  NewScrape();
  for (int i = 0; i < 10; ++i) EXPECT_EQ(SeriesOf("rcan://z/" + std::to_string(i)), kBasic);
  EXPECT_EQ(SeriesOf("rcan://a/0000"), kBasic);
  EXPECT_EQ(probe_.series.value(), 150);
  EXPECT_EQ(probe_.robots_left_out.value(), 160);
  EXPECT_EQ(probe_.robots_incomplete.value(), 50);
  EXPECT_EQ(probe_.series_no_room_total.value(), 40 * 509 + 10 * 3);
}

TEST_F(SharedRoomTest, TheSameRobotsHaveRoomAtEachScrape) {
  config_.series_max = 2000;
  Invent(6, 400, "g");
  robot::Robot& honest = Robot("rcan://z");
  SayJoints(honest, 50);
  NewScrape();
  std::vector<std::size_t> shown;
  const auto look = [&] {
    shown.clear();
    for (int i = 0; i < 6; ++i) shown.push_back(SeriesOf(fmt::format("rcan://a/{:04}", i)));
  };
  look();
  const std::vector<std::size_t> first = shown;
  for (const std::size_t joints : {10U, 50U, 0U, 30U}) {
    SayJoints(honest, joints);
    NewScrape();
    EXPECT_EQ(SeriesOf("rcan://z"), kBasic + joints);
    look();
    EXPECT_EQ(shown, first);
  }
}

TEST_F(SharedRoomTest, ATwinsMetricsAreNamedSeriesToo) {
  const std::string ruri = "rcan://local.rcan/cyberwave/twin/" + std::string(test::kTwin);
  config_.series_max = 6;
  static_cast<void>(Robot(ruri));
  const auto id = *model::cyberwave::Uuid::FromText(test::kTwin);
  for (const auto& [tail, payload] : {std::pair{"joint/update", R"({"positions":{"a":1,"b":2}})"},
                                      std::pair{"battery/status", R"({"percentage":80})"}}) {
    static_cast<void>(twins_.Apply(*twins_.FindOrAdd(ruri, id), test::JudgeOn(tail, payload),
                                   {.steady = clock_.Steady(), .system = clock_.System()}));
  }
  NewScrape();
  EXPECT_EQ(SeriesOf(ruri), 6U);
  config_.series_max = 5;
  scrape_.reset();
  NewScrape();
  EXPECT_EQ(SeriesOf(ruri), 4U) << "its battery is there, and no joint";
  EXPECT_THAT(lines_, SizeIs(1));
  EXPECT_THAT(lines_.front(), HasSubstr("most_way=broker"));
}

}  // namespace
}  // namespace uplink::rcan
