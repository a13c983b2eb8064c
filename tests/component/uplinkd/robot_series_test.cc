// What the real program shows Prometheus of a robot that names its joints anew, of a gateway that
// invents robots, and of their neighbours.
#include <cstdio>
#include <fstream>
#include <memory>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/component/uplinkd/uplinkd_fixture.h"

namespace uplink::testing {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::SizeIs;

using Names = std::set<std::string>;

constexpr const char* kRenames = "rcan://a";
constexpr const char* kHonest = "rcan://b";
constexpr int kSeriesPerJoint = 3;

/// A Robot State; its joints are called `word` and their number.
std::string State(const std::string& ruri, std::uint64_t seq, const std::string& word, int joints) {
  std::string state = fmt::format(R"({{"ruri":"{}","timestamp_us":{},"joints":[)", ruri, seq);
  for (int i = 0; i < joints; ++i) {
    state += fmt::format(
        R"({}{{"joint":"{}{}","timestamp_us":{},"position_rad":1,"effort_nm":2,"temperature_c":3}})",
        i == 0 ? "" : ",", word, i, seq);
  }
  return state + "]}";
}

/// Prometheus' own checker; 3: it has remarks on units of RCAN's names, which are not ours.
std::optional<int> Promtool(const std::string& path) {
  ServerProcess checker({"/bin/sh", "-c", "exec promtool check metrics < \"$0\"", path});
  return checker.WaitForExit();
}

class RobotSeries : public UplinkdTest {
 protected:
  void SetUp() override { Serve(); }
  std::unique_ptr<TestAgent> Agent(const std::string& ruri, const std::string& fleet = "") {
    auto agent = std::make_unique<TestAgent>(Channel(RobotSpec(ruri, fleet)),
                                             TestAgent::Options{.patience = 3 * kPatience});
    EXPECT_TRUE(agent->Connect(model::SessionId()));
    return agent;
  }
  /// A robot's stream through a gateway's channel.
  static std::unique_ptr<TestAgent> Relayed(const std::shared_ptr<grpc::Channel>& gateway,
                                            const std::string& ruri) {
    auto agent =
        std::make_unique<TestAgent>(gateway, TestAgent::Options{.patience = 3 * kPatience});
    v1::RelayRequest hello = HelloFrame(model::SessionId());
    hello.mutable_hello()->set_robot_ruri(ruri);
    EXPECT_TRUE(agent->Send(hello));
    const auto answer = agent->Read();
    EXPECT_TRUE(answer && answer->has_welcome());
    return agent;
  }
  std::shared_ptr<grpc::Channel> Gateway(const std::string& name) {
    CertificateSpec spec;
    spec.common_names = {name};
    spec.organizations = {"default"};
    spec.units = {"gateway"};
    return Channel(spec);
  }
  static void Send(TestAgent& agent, std::uint64_t seq, const std::string& state) {
    v1::RelayRequest frame;
    v1::Uplink& uplink = *frame.mutable_batch()->add_uplinks();
    uplink.set_seq(seq);
    uplink.set_rcan_robot_state(state);
    ASSERT_TRUE(agent.Send(frame));
    ASSERT_TRUE(agent.ReadJudged(seq));
    ASSERT_THAT(agent.rejects(), SizeIs(0));
  }
  /// The last scrape is what Prometheus reads.
  void CheckFormat() const {
    std::ofstream(folder_.Path("scrape.txt")) << text_;
    const std::optional<int> code = Promtool(folder_.Path("scrape.txt"));
    EXPECT_TRUE(code == 0 || code == 3) << code.value_or(-1);
  }
  void Scrape() { text_ = HttpGet(http_, "/metrics/robots").body; }
  /// The names of a robot's series in the last scrape that have this in them.
  [[nodiscard]] Names NamesOf(const std::string& ruri, const std::string& part) const {
    Names names;
    std::istringstream lines(text_);
    for (std::string line; std::getline(lines, line);) {
      if (line.find("ruri=\"" + ruri + "\"") == std::string::npos) continue;
      if (line.find(part) != std::string::npos) names.insert(line.substr(0, line.rfind(' ')));
    }
    return names;
  }

  std::string text_;
};

TEST_F(RobotSeries, ARobotThatRenamesItsJointsCostsItselfAlone) {
  constexpr int kRounds = 5;
  constexpr int kJoints = 200;
  const auto renames = Agent(kRenames);
  const auto honest = Agent(kHonest);
  Names all;
  for (int round = 1; round <= kRounds; ++round) {
    const auto seq = static_cast<std::uint64_t>(round);
    Send(*renames, seq, State(kRenames, seq, fmt::format("round{}_", round), kJoints));
    Send(*honest, seq, State(kHonest, seq, "joint", 10));
    Scrape();
    EXPECT_THAT(NamesOf(kHonest, "joint="), SizeIs(10 * kSeriesPerJoint));
    EXPECT_LE(NamesOf(kRenames, "rcan_").size(), 512U);
    EXPECT_THAT(NamesOf(kRenames, "rcan_robot_online"), SizeIs(1));
    all.merge(NamesOf(kRenames, "joint="));
  }
  EXPECT_GE(all.size(), 500U) << "its first names are there at once";
  EXPECT_LE(all.size(), 512U) << "and no place is free before rcan.series_ttl";

  const std::string metrics = HttpGet(http_, "/metrics").body;
  EXPECT_THAT(metrics, HasSubstr("\nuplinkd_rcan_robots_incomplete 1\n"));
  EXPECT_THAT(metrics, HasSubstr("\nuplinkd_rcan_robots_left_out 0\n"));
  EXPECT_THAT(
      metrics,
      ContainsRegex("\nuplinkd_rcan_series_left_out_total\\{cause=\"robot_series_max\"\\} [1-9]"));
  ASSERT_TRUE(process_->WaitFor("warn rcan_series_left_out robot=rcan://a ")) << process_->text();
  const std::size_t named = process_->text().find("rcan_series_left_out");
  EXPECT_EQ(process_->text().find("rcan_series_left_out", named + 1), std::string::npos);

  CheckFormat();
}

TEST_F(RobotSeries, RobotsThatAGatewayInventsHideNoOtherRobots) {
  constexpr int kInvented = 12;
  constexpr int kJoints = 169;
  /// What it is, whether it is online, and when it was last heard.
  constexpr int kBasic = 3;
  /// By their names, seven of the invented ones leave no room for a robot with six series.
  constexpr std::size_t kSeriesMax = 7 * (kJoints * kSeriesPerJoint + kBasic) + 5;
  constexpr const char* kOtherFleet = "rcan://z/south";
  constexpr const char* kRelayed = "rcan://z/relayed";
  process_.reset();
  folder_.WriteConfig(fmt::format("[rcan]\nseries_max = {}\n", kSeriesMax));
  Serve();
  const auto hostile = Gateway("hostile");
  const auto honest_gateway = Gateway("honest");
  std::vector<std::unique_ptr<TestAgent>> streams;
  const auto say = [&](std::unique_ptr<TestAgent> agent, const std::string& ruri, int joints) {
    Send(*agent, 1, State(ruri, 1, "joint", joints));
    streams.push_back(std::move(agent));
  };
  for (int i = 0; i < kInvented; ++i) {
    const std::string ruri = fmt::format("rcan://a/{:02}", i);
    say(Relayed(hostile, ruri), ruri, kJoints);
  }
  say(Agent(kHonest), kHonest, 1);
  say(Agent(kOtherFleet, "south"), kOtherFleet, 1);
  say(Relayed(honest_gateway, kRelayed), kRelayed, 1);
  Scrape();
  for (const char* ruri : {kHonest, kOtherFleet, kRelayed}) {
    EXPECT_THAT(NamesOf(ruri, "joint="), SizeIs(kSeriesPerJoint)) << ruri;
    EXPECT_THAT(NamesOf(ruri, "rcan_"), SizeIs(kSeriesPerJoint + kBasic)) << ruri;
  }
  EXPECT_THAT(NamesOf("rcan://a/00", "joint="), SizeIs(kJoints * kSeriesPerJoint));
  EXPECT_THAT(NamesOf(fmt::format("rcan://a/{:02}", kInvented - 1), "rcan_"), SizeIs(kBasic));

  const std::string metrics = HttpGet(http_, "/metrics").body;
  EXPECT_THAT(metrics, HasSubstr("\nuplinkd_degraded{reason=\"series_max\"} 1\n"));
  EXPECT_THAT(metrics, HasSubstr("\nuplinkd_rcan_robots_left_out 0\n"));
  EXPECT_THAT(metrics, ContainsRegex("\nuplinkd_rcan_robots_incomplete [1-9]"));
  EXPECT_THAT(metrics, ContainsRegex(
                           "\nuplinkd_rcan_series_left_out_total\\{cause=\"series_max\"\\} [1-9]"));
  const auto ready = HttpGet(http_, "/readyz");
  EXPECT_EQ(ready.status, 200);
  EXPECT_THAT(ready.body, HasSubstr("series_max"));
  ASSERT_TRUE(process_->WaitFor("warn rcan_robots_left_out ")) << process_->text();
  ASSERT_TRUE(process_->WaitFor("CN=hostile,OU=gateway,O=default")) << process_->text();
  CheckFormat();
}

}  // namespace
}  // namespace uplink::testing
