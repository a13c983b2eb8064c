#include "server/fleet/live_budget.h"

#include <cstddef>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/cyberwave/judge.h"
#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"
#include "tests/support/records.h"

namespace uplink::fleet {
namespace {

using std::chrono::seconds;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr std::int64_t kNow = 1'763'683'200'000;
constexpr std::size_t kBudget = 1'000'000;
/// Of one reading, which holds some 4.2 kB.
constexpr std::size_t kText = 4'000;
constexpr const char* kGateway = "CN=gateway-1,OU=gateway,O=f";
constexpr const char* kTwin = "11111111-2222-4333-8444-555555555555";
constexpr const char* kOtherTwin = "22222222-2222-4333-8444-555555555555";

class LiveBudgetTest : public ::testing::Test {
 protected:
  RobotPtr Add(const std::string& ruri, const std::string& gateway = {}) {
    RobotPtr robot = *fleet_.FindOrAdmit({ruri, "f"});
    robot->SetSpeaker(gateway);
    return robot;
  }
  /// `count` readings of kText bytes, under keys from `first` on.
  void Read(const RobotPtr& robot, std::size_t count, std::size_t first = 0) {
    for (std::size_t i = first; i < first + count; ++i) {
      std::vector<model::Record> records;
      records.push_back(test::RecordOf(model::TelemetryExtras{
          .unix_time_ms = kNow,
          .kv = {
              {.key = std::to_string(i), .value = std::string(kText, 'x'), .unix_time_ms = {}}}}));
      robot->state.Apply(records, clock_.Steady());
    }
  }
  /// As many readings as that, of an earlier life of the server.
  static void Restore(const RobotPtr& robot, std::size_t count) {
    robot::LiveBefore before;
    for (std::size_t i = 0; i < count; ++i) {
      robot::PutInto(before.parts, model::TelemetryExtras{.unix_time_ms = kNow,
                                                          .kv = {{.key = std::to_string(i),
                                                                  .value = std::string(kText, 'x'),
                                                                  .unix_time_ms = {}}}});
    }
    robot->state.Restore(std::move(before), robot->state.held_since());
  }
  void Say(const std::string& twin_id, const std::string& tail, const std::string& payload) {
    const cyberwave::TwinPtr twin =
        twins_.FindOrAdd(twin_id, *model::cyberwave::Uuid::FromText(twin_id));
    const std::string topic = fmt::format("cyberwave/twin/{}/{}", twin_id, tail);
    (void)twins_.Apply(*twin, cyberwave::JudgeMessage(topic, payload, cyberwave::JudgeTerms()), {});
  }
  void Report(const std::string& twin_id, const std::string& name, std::size_t bytes) {
    Say(twin_id, "telemetry",
        fmt::format(R"({{"telemetry_type":"{}","data":{{"text":"{}"}}}})", name,
                    std::string(bytes, 'x')));
  }
  [[nodiscard]] static std::size_t Readings(const RobotPtr& robot) {
    return robot->state.Snapshot(robot::RobotState::Parts::kAll).parts.extras.items().size();
  }
  [[nodiscard]] std::size_t Reports(const std::string& twin_id) const {
    std::size_t reports = 0;
    twins_.Find(twin_id)->LookAt(
        [&reports](const cyberwave::TwinParts& parts) { reports = parts.reports.size(); });
    return reports;
  }
  /// A second passes.
  void Round() {
    clock_.Advance(seconds(1));
    budget_.Round();
  }

  testing::ManualClock clock_;
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                      log::Level::kInfo};
  Fleet fleet_{clock_, 1'000, {}};
  cyberwave::Twins twins_{100, fleet_.live_total()};
  LiveBudget budget_{{clock_, fleet_, twins_, logger_, kBudget}};
};

TEST_F(LiveBudgetTest, WithinItNobodyLosesAnything) {
  const RobotPtr robot = Add("rcan://a");
  Read(robot, 50);
  Round();
  EXPECT_EQ(Readings(robot), 50U);
  EXPECT_EQ(budget_.parts_dropped(), 0U);
  EXPECT_FALSE(budget_.over());
  EXPECT_THAT(lines_, IsEmpty());
}

TEST_F(LiveBudgetTest, PastItTheGatewayThatBroughtMostLosesAndNobodyElse) {
  const RobotPtr honest = Add("rcan://a");
  const RobotPtr other = Add("rcan://b", "CN=gateway-2");
  Read(honest, 40);
  Read(other, 10);
  std::vector<RobotPtr> invented;
  for (int i = 0; i < 100; ++i) {
    // Each holds less than the honest one: together they hold most.
    invented.push_back(Add(fmt::format("rcan://x/{}", i), kGateway));
    Read(invented.back(), 20);
    EXPECT_LE(budget_.bytes(), kBudget) << i;
  }
  EXPECT_EQ(Readings(honest), 40U);
  EXPECT_EQ(Readings(other), 10U);
  EXPECT_GT(budget_.parts_dropped(), 50U);
  EXPECT_GT(budget_.bytes(), kBudget / 2) << "no more goes than has to";
  EXPECT_TRUE(budget_.over());
  Round();
  EXPECT_THAT(lines_,
              ElementsAre(AllOf(HasSubstr("live_state_dropped"), HasSubstr(kGateway),
                                HasSubstr(" other_holders=0 parts_total="),
                                HasSubstr(" bytes_total="), HasSubstr("live_bytes_max=1000000"))));
}

TEST_F(LiveBudgetTest, ARobotCountsForItsGatewayAfterItsStreamAndForItselfByItsOwn) {
  const RobotPtr robot = Add("rcan://a", kGateway);
  Read(robot, 60);
  robot->SetSpeaker("");
  for (int i = 0; i < 4; ++i) Read(Add(fmt::format("rcan://x/{}", i), kGateway), 45);
  Round();
  EXPECT_EQ(Readings(robot), 60U) << "by itself it holds less than the gateway's robots";
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("gateway=")));
}

TEST_F(LiveBudgetTest, ARobotByItselfIsNamedByItsRuri) {
  const RobotPtr honest = Add("rcan://a");
  Read(honest, 20);
  const RobotPtr most = Add("rcan://most");
  Read(most, 63);
  std::vector<RobotPtr> others;
  for (int i = 0; i < 3; ++i) {
    others.push_back(Add(fmt::format("rcan://b/{}", i)));
    Read(others.back(), 55);
  }
  Round();
  EXPECT_EQ(budget_.parts_dropped(), 1U);
  EXPECT_EQ(Readings(most), 0U);
  EXPECT_EQ(Readings(honest), 20U);
  for (const RobotPtr& other : others) EXPECT_EQ(Readings(other), 55U);
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("robot=rcan://most")));
}

TEST_F(LiveBudgetTest, TheTwinThatHoldsMostLosesItsLargestTable) {
  std::vector<RobotPtr> robots;
  for (int i = 0; i < 4; ++i) {
    robots.push_back(Add(fmt::format("rcan://a/{}", i)));
    Read(robots.back(), 45);
  }
  Report(kOtherTwin, "one", 30'000);
  for (int i = 0; i < 8; ++i) Report(kTwin, fmt::format("r{}", i), 50'000);
  EXPECT_GT(twins_.tables_dropped(), 0U);
  for (const RobotPtr& robot : robots) EXPECT_EQ(Readings(robot), 45U);
  EXPECT_EQ(Reports(kOtherTwin), 1U);
  Round();
  EXPECT_THAT(lines_, ElementsAre(HasSubstr(fmt::format("twin={}", kTwin))));
}

/// The live data of a drone's calls, which is dropped all at once.
class HeldCalls final : public robot::CallsLive {
 public:
  explicit HeldCalls(const std::shared_ptr<robot::LiveTotal>& total) { share_.CountIn(total); }
  void Say(std::size_t bytes) { share_.Set(bytes); }
  [[nodiscard]] std::size_t live_bytes() const override { return share_.bytes(); }
  std::size_t DropLive() override {
    const std::size_t held = share_.bytes();
    share_.Set(0);
    return held;
  }

 private:
  robot::LiveShare share_;
};

TEST_F(LiveBudgetTest, WhatADronesCallsSayCountsForItAndIsDroppedLikeAPart) {
  const RobotPtr drone = Add("rcan://drone");
  const RobotPtr other = Add("rcan://other");
  HeldCalls said(fleet_.live_total());
  drone->calls.Begin(&said);
  Read(other, 20);
  said.Say(kBudget);
  Round();
  EXPECT_EQ(said.live_bytes(), 0U);
  EXPECT_EQ(Readings(other), 20U);
  EXPECT_EQ(budget_.parts_dropped(), 1U);
  drone->calls.End(&said);
}

TEST_F(LiveBudgetTest, WhatIsRestoredIsRelievedByTheNextRound) {
  std::vector<RobotPtr> robots;
  for (int i = 0; i < 6; ++i) {
    robots.push_back(Add(fmt::format("rcan://a/{}", i)));
    Restore(robots.back(), 50);
  }
  EXPECT_GT(budget_.bytes(), kBudget);
  EXPECT_TRUE(budget_.over());
  Round();
  EXPECT_LE(budget_.bytes(), kBudget);
  EXPECT_EQ(budget_.parts_dropped(), 2U);
}

TEST_F(LiveBudgetTest, AfterARestartRobotsThatWereNotHeardCountTogether) {
  const RobotPtr honest = Add("rcan://a");
  std::vector<RobotPtr> not_heard;
  for (int i = 0; i < 200; ++i) {
    not_heard.push_back(*fleet_.FindOrAdmit({fmt::format("rcan://x/{}", i), "f"}));
    Restore(not_heard.back(), 1);
  }
  // Alone it holds more than any other robot; some of the others were a gateway's, which is not
  // known.
  Read(honest, 60);
  Round();
  EXPECT_GT(budget_.parts_dropped(), 0U);
  EXPECT_EQ(Readings(honest), 60U);
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("robots=not_heard")));
}

TEST_F(LiveBudgetTest, ARobotThatWasHeardCountsForItsCertificateAndNoMoreWithThoseThatWereNot) {
  const RobotPtr most = Add("rcan://most", kGateway);
  Read(most, 60);
  std::vector<RobotPtr> robots;
  for (int i = 0; i < 6; ++i) {
    robots.push_back(*fleet_.FindOrAdmit({fmt::format("rcan://a/{}", i), "f"}));
    Restore(robots.back(), 30 + static_cast<std::size_t>(i));
  }
  for (const RobotPtr& robot : robots) robot->SetSpeaker("");
  Round();
  EXPECT_EQ(budget_.parts_dropped(), 1U);
  EXPECT_EQ(Readings(most), 0U);
  EXPECT_EQ(Readings(robots.back()), 35U);
}

TEST_F(LiveBudgetTest, OneLineAMinuteSaysWhatAllLostSinceTheLast) {
  const auto flood = [this](int first) {
    for (int i = first; i < first + 60; ++i) {
      Read(Add(fmt::format("rcan://x/{}", i), kGateway), 10);
    }
  };
  flood(0);
  Round();
  ASSERT_THAT(lines_, SizeIs(1));
  flood(100);
  Round();
  EXPECT_THAT(lines_, SizeIs(1));
  clock_.Advance(kLiveLineEvery);
  Round();
  EXPECT_THAT(lines_, SizeIs(2));
  clock_.Advance(kLiveLineEvery);
  Round();
  EXPECT_THAT(lines_, SizeIs(2)) << "nothing more was lost";
}

TEST_F(LiveBudgetTest, DegradedEndsTenMinutesAfterTheLastPart) {
  for (int i = 0; i < 60; ++i) Read(Add(fmt::format("rcan://x/{}", i), kGateway), 10);
  ASSERT_GT(budget_.parts_dropped(), 0U);
  clock_.Advance(kLiveDroppedShown - seconds(1));
  EXPECT_TRUE(budget_.over());
  clock_.Advance(seconds(1));
  EXPECT_FALSE(budget_.over());
}

TEST_F(LiveBudgetTest, WhatIsNoPartIsNotLookedForAtEachMessage) {
  for (int i = 0; i < 50; ++i) {
    Say(fmt::format("{:08x}-2222-4333-8444-555555555555", i), "position",
        R"({"position":{"x":1,"y":2,"z":3}})");
  }
  // A twin holds more than its tables: past a budget below that, nothing is left to drop.
  LiveBudget tight({clock_, fleet_, twins_, logger_, budget_.bytes() / 2});
  Report(kTwin, "one", 100);
  EXPECT_EQ(Reports(kTwin), 0U);
  EXPECT_TRUE(tight.over());
  Report(kTwin, "two", 1);
  EXPECT_EQ(Reports(kTwin), 1U) << "little was added since the last look";
  tight.Round();
  EXPECT_EQ(Reports(kTwin), 0U);
}

TEST_F(LiveBudgetTest, ManyThreadsThatGrowAtOnceStayNearIt) {
  constexpr std::size_t kThreads = 4;
  std::vector<std::vector<RobotPtr>> robots(kThreads);
  for (std::size_t thread = 0; thread < kThreads; ++thread) {
    for (int i = 0; i < 20; ++i) {
      robots[thread].push_back(Add(fmt::format("rcan://{}/{}", thread, i), kGateway));
    }
  }
  std::vector<std::jthread> threads;
  threads.reserve(kThreads);
  for (const std::vector<RobotPtr>& of_thread : robots) {
    threads.emplace_back([this, &of_thread] {
      for (const RobotPtr& robot : of_thread) Read(robot, 20);
    });
  }
  threads.clear();
  Round();
  EXPECT_LE(budget_.bytes(), kBudget);
  std::size_t held = 0;
  for (const auto& of_thread : robots) {
    for (const RobotPtr& robot : of_thread) held += robot->state.live_bytes();
  }
  EXPECT_EQ(budget_.bytes(), held) << "each robot's count is in the total, once";
  EXPECT_GT(budget_.parts_dropped(), 0U);
}

}  // namespace
}  // namespace uplink::fleet
