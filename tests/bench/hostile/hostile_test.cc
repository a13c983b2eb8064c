#include <array>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/bench/hostile/attack.h"
#include "tests/bench/hostile/hostile_report.h"
#include "tests/bench/hostile/traces.h"
#include "tests/bench/trouble_flags.h"

namespace uplink::bench {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

template <typename... Arguments>
std::optional<int> Parse(HostileFlags& flags, Arguments... arguments) {
  const std::array<const char*, sizeof...(arguments) + 1> all = {"program", arguments...};
  return ParseHostileFlags(static_cast<int>(all.size()), all.data(), NamesOf(Attacks()), flags);
}

/// Figures that meet every goal.
HostileResult Met() {
  HostileResult result{.attack = "resets"};
  result.new_robot_after = milliseconds(5);
  result.new_robot_during = milliseconds(9);
  result.ack_ms_without = {1, 1, 1};
  result.ack_ms_with = {1, 1, 3};
  result.acked = 6;
  result.growth_mib = 2;
  result.in_log = true;
  result.metric = "resets 50";
  return result;
}

/// What the table says is missed: one word, at the end of the line.
std::string MissedIn(const HostileResult& result) {
  const std::string table = HostileTable({result});
  const std::size_t line = table.find("\nresets ") + 1;
  const std::string text = table.substr(line, table.find('\n', line) - line);
  return text.substr(text.rfind(' ') + 1);
}

/// A figure of the attack in JSON.
double Value(const std::vector<HostileResult>& results, const std::string& figure) {
  for (const Row& row : HostileRows(results)) {
    if (row.scenario == "resets_" + figure) return row.value.median();
  }
  ADD_FAILURE() << "no row " << figure;
  return 0;
}

TEST(AttackTest, EveryOneHasANameByWhichItIsFound) {
  std::set<std::string_view> names;
  for (const Attack& attack : Attacks()) {
    EXPECT_EQ(AttackOf(attack.name), &attack);
    EXPECT_TRUE(names.insert(attack.name).second) << attack.name;
    EXPECT_FALSE(attack.about.empty());
    EXPECT_NE(attack.run, nullptr);
  }
  EXPECT_EQ(AttackOf("politeness"), nullptr);
}

TEST(HostileFlagsTest, WithoutAnyAllAttacksRun) {
  HostileFlags flags;
  EXPECT_EQ(Parse(flags), std::nullopt);
  EXPECT_THAT(ChosenOf(Attacks(), flags.only), SizeIs(Attacks().size()));
}

TEST(HostileFlagsTest, NamesChooseAmongThem) {
  HostileFlags flags;
  EXPECT_EQ(Parse(flags, "--only", "pings", "--only", "resets"), std::nullopt);
  EXPECT_THAT(ChosenOf(Attacks(), flags.only), ElementsAre(AttackOf("pings"), AttackOf("resets")));
}

TEST(HostileFlagsTest, WhatDoesNotExistIsWrongUse) {
  HostileFlags flags;
  EXPECT_NE(Parse(flags, "--only", "politeness").value_or(0), 0);
}

TEST(HostileReportTest, WhatMeetsEveryGoalMissesNone) { EXPECT_EQ(MissedIn(Met()), "-"); }

TEST(HostileReportTest, EachMissedGoalIsNamed) {
  const auto with = [](auto change) {
    HostileResult result = Met();
    change(result);
    return MissedIn(result);
  };
  EXPECT_EQ(with([](HostileResult& r) { r.new_robot_after.reset(); }), "serves");
  EXPECT_EQ(with([](HostileResult& r) { r.server_ended = true; }), "serves");
  EXPECT_EQ(with([](HostileResult& r) { r.lost = 1; }), "lost");
  EXPECT_EQ(with([](HostileResult& r) { r.unacked = 1; }), "lost");
  EXPECT_EQ(with([](HostileResult& r) { r.growth_mib = kGrowthMaxMiB + 1; }), "memory");
  EXPECT_EQ(with([](HostileResult& r) { r.in_log = false; }), "log");
  EXPECT_EQ(with([](HostileResult& r) { r.metric.clear(); }), "metric");
  EXPECT_EQ(with([](HostileResult& r) { r.new_robot_during.reset(); }), "new");
  EXPECT_EQ(with([](HostileResult& r) { r.ack_ms_with = {4}; }), "ack");
}

TEST(HostileReportTest, OfSeveralRoundsTheWorstIsShownAndWaitsArePutTogether) {
  HostileResult worse = Met();
  worse.new_robot_during = milliseconds(700);
  worse.growth_mib = 30;
  worse.cut = 1;
  worse.ack_ms_with = {2};
  const std::vector<HostileResult> rounds = {Met(), worse, Met()};
  EXPECT_EQ(Value(rounds, "new_robot_during"), 700);
  EXPECT_EQ(Value(rounds, "growth"), 30);
  EXPECT_EQ(Value(rounds, "cut"), 1);
  EXPECT_EQ(Value(rounds, "acked"), 18);
  EXPECT_EQ(Value(rounds, "ack_p99"), 3);
  EXPECT_EQ(Value(rounds, "serves_after"), 1);
}

TEST(HostileReportTest, AttacksWithoutFiguresAreSaid) {
  HostileResult failed{.attack = "pings", .failure = "no server"};
  EXPECT_THAT(HostileTable({failed}), HasSubstr("pings: no figures: no server"));
  EXPECT_THAT(HostileRows({failed}), SizeIs(0));
}

TEST(HostileReportTest, WhatHasNoValueIsNegativeInJson) {
  HostileResult result = Met();
  result.new_robot_after.reset();
  EXPECT_EQ(Value({result}, "new_robot_after"), -1);
  EXPECT_EQ(Value({result}, "serves_after"), 0);
}

TEST(TracesTest, AWarningThatNamesTheAttackerDoes) {
  const std::string source = "T warn a_thing source=127.0.0.66 why=x";
  EXPECT_EQ(LineThatNames("T info fine\n" + source + "\nT info fine\n"), source);
  const std::string peer = "T error a_thing peer=127.0.0.120:77";
  EXPECT_EQ(LineThatNames(peer), peer);
  const std::string robot = "T warn a_thing robot=" + std::string(kAttackerRuri);
  EXPECT_EQ(LineThatNames(robot + "\n" + source), robot);
}

TEST(TracesTest, OtherLinesDoNot) {
  EXPECT_EQ(LineThatNames(""), "");
  EXPECT_EQ(LineThatNames("T info a_thing source=127.0.0.66 \n"), "");
  EXPECT_EQ(LineThatNames("T warn a_thing peer=127.0.0.1:5\nT info source=127.0.0.66 \n"), "");
  EXPECT_EQ(LineThatNames("T warn a_thing source=127.0.0.200 peer=127.0.0.200:66\n"), "");
}

TEST(TracesTest, WhatGrewMostIsNamedByItsLabel) {
  const std::string away = "uplinkd_connections_turned_away_total";
  EXPECT_EQ(GrownMost({{away + "{cause=\"resets\"}", 2}},
                      {{away + "{cause=\"resets\"}", 52}, {away + "{cause=\"key\"}", 3}}),
            "resets 50");
  EXPECT_EQ(GrownMost({}, {{"uplinkd_peer_stalls_total", 1}}), "peer_stalls 1");
}

TEST(TracesTest, WhatDidNotGrowOrIsNoTraceIsNot) {
  EXPECT_EQ(GrownMost({{"uplinkd_peer_stalls_total", 1}}, {{"uplinkd_peer_stalls_total", 1}}), "");
  EXPECT_EQ(GrownMost({}, {{"uplinkd_streams_total", 9}}), "");
}

}  // namespace
}  // namespace uplink::bench
