// Scrapes of many robots: who is left out, whose memory it is.
#include "server/rcan/scrape.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"
#include "tests/support/records.h"
#include "tests/unit/schema/cyberwave/judging.h"

namespace uplink::rcan {
namespace {

using metrics::Coding;
using metrics::Format;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

class ScrapeTest : public ::testing::Test {
 protected:
  robot::Robot& Robot(const std::string& ruri, const std::string& fleet_name = "default") {
    const fleet::RobotPtr robot = *fleet_.FindOrAdmit({ruri, fleet_name});
    robot->state.SignOfLife(clock_.Steady(), clock_.System(), {});
    return *robot;
  }
  void GiveMotion(robot::Robot& robot) {
    std::vector<model::Record> records;
    model::MotionTelemetry motion;
    motion.pose = model::Pose{.lat_deg = 1, .lon_deg = 2};
    records.push_back(test::RecordOf(motion));
    robot.state.Apply(records, clock_.Steady());
  }
  /// Publishes a message of the twin, whose robot is `twin_ruri_`.
  void Publish(std::string_view tail, std::string_view payload) {
    const auto id = *model::cyberwave::Uuid::FromText(test::kTwin);
    static_cast<void>(twins_.Apply(*twins_.FindOrAdd(twin_ruri_, id), test::JudgeOn(tail, payload),
                                   {.steady = clock_.Steady(), .system = clock_.System()}));
  }
  RobotScrape& Scrape() {
    if (!scrape_)
      scrape_.emplace(
          RobotScrape::Sources{clock_, fleet_, config_, faults_, probe_, logger_, {}, &twins_});
    return *scrape_;
  }
  std::string Text() { return *Scrape().Text(Format::kText, Coding::kPlain); }
  /// Later than any text is shared.
  std::string NewText() {
    clock_.Advance(kTextShared);
    return Text();
  }

  testing::ManualClock clock_;
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                      log::Level::kInfo};
  fleet::Fleet fleet_{clock_, 100, {}};
  config::RcanConfig config_;
  view::FaultCounts faults_{clock_};
  cyberwave::Twins twins_{10};
  RcanProbe probe_;
  const std::string twin_ruri_ = "rcan://local.rcan/cyberwave/twin/" + std::string(test::kTwin);
  std::optional<RobotScrape> scrape_;
};

TEST_F(ScrapeTest, RobotsStandInTheOrderOfTheirRuris) {
  Robot("rcan://b");
  Robot("rcan://a");
  EXPECT_THAT(Text(), HasSubstr("rcan_robot_online{ruri=\"rcan://a\"} 1\n"
                                "rcan_robot_online{ruri=\"rcan://b\"} 1\n"));
  Robot("rcan://aa");
  EXPECT_THAT(Text(), HasSubstr("\"rcan://aa\"} 1\nrcan_robot_online{ruri=\"rcan://b\"}"));
  EXPECT_EQ(probe_.series.value(), 9);
}

TEST_F(ScrapeTest, OnlyTheFleetsThatAreAllowedAreShown) {
  config_.fleets = {"north", "south"};
  Robot("rcan://a", "north");
  Robot("rcan://b", "east");
  EXPECT_THAT(Text(), HasSubstr("rcan://a"));
  EXPECT_THAT(Text(), Not(HasSubstr("rcan://b")));
  EXPECT_EQ(probe_.robots_left_out.value(), 0) << "it was not asked for";
}

TEST_F(ScrapeTest, OnlyTheFleetsThatAreAskedForAreShownAndNoneThatIsNotAllowed) {
  config_.fleets = {"north", "south"};
  for (const char* fleet : {"north", "south", "east"}) Robot(std::string("rcan://") + fleet, fleet);
  const auto text = [this](const std::vector<std::string>& fleets) {
    return *Scrape().Text(Format::kText, Coding::kPlain, kTextsMax, fleets);
  };
  // Within the time in which a text is shared.
  EXPECT_THAT(text({"east", "south"}), HasSubstr("rcan://south"));
  EXPECT_THAT(text({"east", "south"}), Not(HasSubstr("rcan://north")));
  EXPECT_THAT(text({"east", "south"}), Not(HasSubstr("rcan://east")));
  EXPECT_THAT(text({"north"}), HasSubstr("rcan://north"));
  EXPECT_THAT(text({"north"}), Not(HasSubstr("rcan://south")));
  EXPECT_THAT(text({}), HasSubstr("rcan://south"));
}

TEST_F(ScrapeTest, RobotsThatDoNotFitAreLeftOutWholeCountedAndSaidOnceAMinute) {
  config_.series_max = 10;
  for (const char* ruri : {"rcan://a", "rcan://b", "rcan://c", "rcan://d"}) Robot(ruri);
  for (int i = 0; i < 3; ++i) {
    EXPECT_THAT(Text(), Not(HasSubstr("rcan://d")));
    EXPECT_EQ(probe_.series.value(), 9);
    EXPECT_EQ(probe_.robots_left_out.value(), 1);
  }
  EXPECT_THAT(lines_, SizeIs(1));
  EXPECT_THAT(lines_.front(), HasSubstr("rcan_robots_left_out robots=1 series_max=10"));
  clock_.Advance(std::chrono::minutes(2));
  static_cast<void>(Text());
  EXPECT_THAT(lines_, SizeIs(2));
}

TEST_F(ScrapeTest, WhoIsLeftOutDoesNotChangeWithTheValuesOfOthers) {
  config_.series_max = 10;
  robot::Robot& first = Robot("rcan://a");
  Robot("rcan://b");
  Robot("rcan://c");
  model::RcanState two;
  two.battery_v = 1;
  two.uptime_ms = 1;
  first.state.Apply(std::move(two), clock_.Steady());
  EXPECT_THAT(Text(), Not(HasSubstr("rcan://c"))) << "5 and 3";
  first.state.Apply(model::RcanState{}, clock_.Steady());
  EXPECT_THAT(NewText(), Not(HasSubstr("rcan://c"))) << "the room is still the first one's";
  EXPECT_THAT(NewText(), HasSubstr("rcan://b"));
  EXPECT_EQ(probe_.series.value(), 6);
}

TEST_F(ScrapeTest, TextsAreUsedAgainWhenTheirReadersAreDone) {
  Robot("rcan://a");
  std::vector<std::shared_ptr<const std::string>> held;
  for (std::size_t i = 0; i < kTextsMax; ++i) {
    held.push_back(Scrape().Text(Format::kText, Coding::kPlain));
    ASSERT_NE(held.back(), nullptr);
    clock_.Advance(kTextShared);
  }
  EXPECT_EQ(Scrape().Text(Format::kText, Coding::kPlain), nullptr);
  EXPECT_EQ(probe_.refused_total.value(), 1);
  const std::string* const first = held.front().get();
  held.front().reset();
  const auto again = Scrape().Text(Format::kOpenMetrics, Coding::kPlain);
  EXPECT_EQ(again.get(), first);
  EXPECT_THAT(*again, EndsWith("# EOF\n"));
}

TEST_F(ScrapeTest, WhoMayTakeFewerTextsLeavesTheRestToOthers) {
  Robot("rcan://a");
  constexpr std::size_t kFewer = kTextsMax - kTextsReserved;
  std::vector<std::shared_ptr<const std::string>> held;
  for (std::size_t i = 0; i < kFewer; ++i) {
    held.push_back(Scrape().Text(Format::kText, Coding::kPlain, kFewer));
    ASSERT_NE(held.back(), nullptr);
    clock_.Advance(kTextShared);
  }
  EXPECT_EQ(Scrape().Text(Format::kText, Coding::kPlain, kFewer), nullptr);
  EXPECT_NE(Scrape().Text(Format::kText, Coding::kPlain), nullptr);
}

TEST_F(ScrapeTest, ScrapersOfSomeFleetsKeepNeitherOthersOutNorWhoScrapesAll) {
  Robot("rcan://a");
  const auto text_of = [this](const std::vector<std::string>& fleets) {
    clock_.Advance(kTextShared);
    return Scrape().Text(Format::kText, Coding::kPlain, kTextsMax, fleets);
  };
  std::vector<std::shared_ptr<const std::string>> held;
  for (std::size_t i = 0; i < kTextsOfFleets; ++i) held.push_back(text_of({"north"}));
  EXPECT_THAT(held, ::testing::Each(::testing::NotNull()));
  EXPECT_EQ(text_of({"north"}), nullptr);
  held.push_back(text_of({"south"}));
  EXPECT_NE(held.back(), nullptr);
  EXPECT_EQ(text_of({"west"}), nullptr) << "one is left to who scrapes all";
  EXPECT_NE(text_of({}), nullptr);
  held.clear();
  EXPECT_NE(text_of({"north"}), nullptr);
}

TEST_F(ScrapeTest, WhoAsksForTheSameWithinASecondReadsTheSameText) {
  Robot("rcan://a");
  const auto first = Scrape().Text(Format::kText, Coding::kPlain);
  EXPECT_EQ(Scrape().Text(Format::kText, Coding::kPlain), first);
  EXPECT_NE(Scrape().Text(Format::kOpenMetrics, Coding::kPlain), first);
  const auto again = Scrape().Text(Format::kText, Coding::kPlain);
  clock_.Advance(kTextShared);
  EXPECT_NE(Scrape().Text(Format::kText, Coding::kPlain), again);
}

TEST_F(ScrapeTest, CompressedIsTheSameTextSmaller) {
  for (int i = 0; i < 50; ++i) Robot("rcan://robot-" + std::to_string(i));
  const std::string plain = Text();
  const auto zipped = Scrape().Text(Format::kText, Coding::kGzip);
  EXPECT_LT(zipped->size(), plain.size() / 4);
  EXPECT_EQ(zipped->substr(0, 2), "\x1f\x8b");
  EXPECT_EQ(probe_.bytes.value(), static_cast<std::int64_t>(plain.size()));
}

TEST_F(ScrapeTest, ATwinHasTheSeriesOfWhatItSaid) {
  Robot(twin_ruri_);
  Publish("joint/update", R"({"positions":{"a":1.5}})");
  Publish("battery/status", R"({"percentage":80})");
  const std::string text = Text();
  const std::string ruri = "ruri=\"" + twin_ruri_ + "\"} ";
  EXPECT_THAT(text, HasSubstr("rcan_robot_online{" + ruri + "1\n"));
  EXPECT_THAT(text, HasSubstr("rcan_robot_battery_pct{" + ruri + "80\n"));
  EXPECT_THAT(text, HasSubstr("rcan_acb_position_rad{joint=\"a\"," + ruri + "1.5\n"));
}

TEST_F(ScrapeTest, TheValuesOfATwinGoAsThoseOfOtherRobots) {
  robot::Robot& robot = Robot(twin_ruri_);
  Publish("battery/status", R"({"percentage":80})");
  EXPECT_THAT(Text(), HasSubstr("battery_pct"));
  const robot::PresenceLimits& limits = fleet_.presence_limits_of(robot);
  robot.state.Sweep(clock_.Steady(), clock_.System(), limits);
  clock_.Advance(limits.timeout + config_.series_ttl - kTextShared - milliseconds(1));
  robot.state.Sweep(clock_.Steady(), clock_.System(), limits);
  EXPECT_THAT(NewText(), HasSubstr("battery_pct"));
  clock_.Advance(milliseconds(1));
  EXPECT_THAT(NewText(), Not(HasSubstr("battery_pct")));
  EXPECT_THAT(NewText(), HasSubstr("rcan_robot_online"));
}

TEST_F(ScrapeTest, WhoDoesNotHoldATwinHasNoSeriesOfIt) {
  const fleet::RobotPtr robot = *fleet_.FindOrAdmit({twin_ruri_, "default"});
  Publish("battery/status", R"({"percentage":80})");
  robot->state.FollowHolder({.held_by = "b:2", .written_at = clock_.System()},
                            {model::Presence::kOnline, clock_.System()});
  EXPECT_THAT(Text(), Not(HasSubstr(twin_ruri_)));
}

TEST_F(ScrapeTest, WhatStandsForNoRobotHasNoSeries) {
  Robot("cyberwave:");
  EXPECT_THAT(Text(), Not(HasSubstr("cyberwave:")));
}

TEST_F(ScrapeTest, IsWantedForAWhileAfterAScrape) {
  EXPECT_FALSE(Scrape().wanted());
  static_cast<void>(Text());
  EXPECT_TRUE(Scrape().wanted());
  clock_.Advance(kScrapedWithin);
  EXPECT_FALSE(Scrape().wanted());
}

}  // namespace
}  // namespace uplink::rcan
