#include "server/run/reload.h"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"

namespace uplink::run {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

TEST(CompareConfigs, SeesNothingInTheSame) {
  const admin::Reloaded changes = CompareConfigs({}, {});
  EXPECT_THAT(changes.taken_over, IsEmpty());
  EXPECT_THAT(changes.needs_restart, IsEmpty());
}

TEST(CompareConfigs, TakesTheLogLevelAndWhatRobotsMaySend) {
  config::Config read;
  read.log.level = config::LogLevel::kDebug;
  read.limits.durable_bytes_rate = 7;
  read.rates.shape_burst = 3;
  const admin::Reloaded changes = CompareConfigs({}, read);
  EXPECT_THAT(changes.taken_over,
              ElementsAre("limits.durable_bytes_rate", "rates.shape_burst", "log.level"));
  EXPECT_THAT(changes.needs_restart, IsEmpty());
}

TEST(CompareConfigs, TakesWhichRobotsComeIn) {
  config::Config read;
  read.identity.registration = config::Registration::kClosed;
  read.identity.gateways = config::Gateways::kNamed;
  read.identity.fleet_moves = config::FleetMoves::kRefuse;
  const admin::Reloaded changes = CompareConfigs({}, read);
  EXPECT_THAT(changes.taken_over,
              ElementsAre("identity.registration", "identity.gateways", "identity.fleet_moves"));
  EXPECT_THAT(changes.needs_restart, IsEmpty());
}

TEST(CompareConfigs, NamesEveryOtherKeyThatChanged) {
  config::Config read;
  read.listen.http.port = 1;
  read.listen.metrics = {"::", 9090};
  read.presence.timeout = config::milliseconds(1);
  const admin::Reloaded changes = CompareConfigs({}, read);
  EXPECT_THAT(changes.taken_over, IsEmpty());
  EXPECT_THAT(changes.needs_restart,
              ElementsAre("listen.http", "listen.metrics", "presence.timeout"));
}

class ReloadTest : public ::testing::Test {
 protected:
  ReloadTest() { read_.config.emplace(); }

  testing::ManualClock clock_;
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                      log::Level::kInfo};
  config::LoadResult read_;
  ingest::Allowances allowances_;
  config::InEffect in_effect_{"u.toml", {}, {}};
  Reload reload_{{}, {[this] { return read_; }, allowances_, logger_, in_effect_}};
};

TEST_F(ReloadTest, TakesTheLevelOverAndSaysSo) {
  read_.config->log.level = config::LogLevel::kError;
  reload_.Run();
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("reloaded taken_over=log.level")));
  EXPECT_FALSE(logger_.Enabled(log::Level::kWarn));
  // The line goes by whichever level lets it through.
  read_.config->log.level = config::LogLevel::kInfo;
  reload_.Run();
  EXPECT_EQ(lines_.size(), 2U);
  reload_.Run();
  EXPECT_THAT(lines_.back(), Not(HasSubstr("log.level")));
}

TEST_F(ReloadTest, RobotsMaySendAsItSaysFromThenOn) {
  read_.config->rates.object = 7;
  read_.config->limits.durable_records_rate = 9;
  read_.config->limits.robots_max = 3;
  read_.places["rates.object"] = "u.toml:3";
  const std::uint64_t before = allowances_.version();
  reload_.Run();
  EXPECT_GT(allowances_.version(), before);
  const auto allowance = allowances_.Get();
  EXPECT_EQ(allowance->rates[static_cast<std::size_t>(model::Variant::kObject)].rate, 7U);
  EXPECT_EQ(allowance->flow.records.rate, 9U);
  EXPECT_THAT(lines_.back(), HasSubstr("needs_restart=limits.robots_max"));
  reload_.Run();
  EXPECT_THAT(lines_.back(), Not(HasSubstr("rates.object"))) << "it is in force already";
  const auto keys = in_effect_.Keys();
  const auto object = std::ranges::find_if(
      keys, [](const auto& key) { return config::FullKey(*key.setting) == "rates.object"; });
  EXPECT_EQ(object->value, "7");
  EXPECT_EQ(object->place, "u.toml:3");
}

TEST_F(ReloadTest, NamesTheRestEachTime) {
  read_.config->listen.http.port = 1;
  for (int run = 0; run < 2; ++run) reload_.Run();
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("needs_restart=listen.http"),
                                  HasSubstr("needs_restart=listen.http")));
}

TEST_F(ReloadTest, AConfigurationWithAProblemChangesNothing) {
  read_.config.reset();
  read_.problems.push_back({.key = "log.level", .text = "must be one of these"});
  reload_.Run();
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("reload_refused")));
  EXPECT_TRUE(logger_.Enabled(log::Level::kInfo));
}

TEST_F(ReloadTest, AFileThatCannotBeUsedLeavesAllAsItWas) {
  int taken = 0;
  Reload reload({}, {.read = [this] { return read_; },
                     .allowances = allowances_,
                     .logger = logger_,
                     .in_effect = in_effect_,
                     .look_at_files = [] { return std::vector<std::string>{"tokens: line 3"}; },
                     .took_over = [&taken](const config::Config&) { ++taken; }});
  read_.config->log.level = config::LogLevel::kError;
  const admin::Reloaded reloaded = reload.Run();
  EXPECT_THAT(reloaded.problems, ElementsAre("tokens: line 3"));
  EXPECT_THAT(reloaded.taken_over, IsEmpty());
  EXPECT_TRUE(logger_.Enabled(log::Level::kWarn));
  EXPECT_EQ(taken, 0);
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("reload_refused")));
}

TEST_F(ReloadTest, TellsWhatItTookOver) {
  std::vector<std::string> hosts;
  Reload reload(
      {}, {.read = [this] { return read_; },
           .allowances = allowances_,
           .logger = logger_,
           .in_effect = in_effect_,
           .look_at_files = {},
           .took_over = [&hosts](const config::Config& running) { hosts = running.http.hosts; }});
  read_.config->http.hosts = {"fleet.example.org"};
  read_.config->presence.timeout = config::milliseconds(1);
  const admin::Reloaded reloaded = reload.Run();
  EXPECT_THAT(reloaded.taken_over, ElementsAre("http.hosts"));
  EXPECT_THAT(reloaded.needs_restart, ElementsAre("presence.timeout"));
  EXPECT_THAT(hosts, ElementsAre("fleet.example.org"));
}

}  // namespace
}  // namespace uplink::run
