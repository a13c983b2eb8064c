// Errors of metrics as faults.
#include "server/cyberwave/metric_faults.h"

#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "schema/base/utf8.h"
#include "schema/limits.h"
#include "tests/unit/server/cyberwave/applying.h"

namespace uplink::cyberwave {
namespace {

std::vector<std::string> Errors(std::size_t from, std::size_t to) {
  std::vector<std::string> errors;
  for (std::size_t i = from; i < to; ++i) errors.push_back("e" + std::to_string(i));
  return errors;
}

/// The message's first record, which is a fault's.
model::Fault FaultIn(const Applied& applied) {
  return std::get<model::Fault>(std::get<model::Record>(applied.records.at(0)).body());
}

TEST(MetricFaultsTest, RaisesWhatIsNewAndClearsWhatIsNamedNoMore) {
  MetricFaults faults;
  const auto raised = faults.Take({"hot", "low"}, 5);
  ASSERT_EQ(raised.size(), 2U);
  EXPECT_EQ(raised[0].fault_id, "hot");
  EXPECT_EQ(raised[0].source, "cyberwave/metrics");
  EXPECT_EQ(raised[0].description, "hot");
  EXPECT_EQ(raised[0].unix_time_ms, 5);
  EXPECT_TRUE(raised[0].active);
  EXPECT_TRUE(faults.Take({"low", "hot", "low"}, 6).empty());
  const auto changed = faults.Take({"low", "new"}, 7);
  ASSERT_EQ(changed.size(), 2U);
  EXPECT_EQ(changed[0].fault_id, "new");
  EXPECT_TRUE(changed[0].active);
  EXPECT_EQ(changed[1].fault_id, "hot");
  EXPECT_FALSE(changed[1].active);
  EXPECT_EQ(changed[1].source, "cyberwave/metrics");
}

TEST(MetricFaultsTest, MetricsWithoutErrorsClear) {
  test::AppliedTwin twin;
  EXPECT_EQ(twin.Publish("metrics", R"({"metrics":{"errors":["hot"]}})").records.size(), 1U);
  EXPECT_EQ(twin.Publish("metrics", R"({"metrics":{"errors":["hot"]}})").records.size(), 0U);
  const Applied cleared = twin.Publish("metrics", R"({"metrics":{"load":1}})");
  EXPECT_EQ(cleared.outcome, Outcome::kStored);
  ASSERT_EQ(cleared.records.size(), 1U);
  EXPECT_FALSE(FaultIn(cleared).active);
  EXPECT_NE(twin.real().metrics.Find("load"), nullptr) << "what is live is applied too";
  twin.Say("metrics", R"({"metrics":{"errors":["hot"]}})");
  EXPECT_EQ(twin.Publish("metrics", R"({"metrics":{"errors":[]}})").records.size(), 1U);
}

TEST(MetricFaultsTest, WhatAnEarlierLifeLeftIsClearedByTheNextMetrics) {
  test::AppliedTwin twin;
  twin.Of(RobotKind::kReal).RestoreFaults({"old", "hot"});
  const Applied applied = twin.Publish("metrics", R"({"metrics":{"errors":["hot"]}})");
  ASSERT_EQ(applied.records.size(), 1U);
  EXPECT_EQ(FaultIn(applied).fault_id, "old");
}

TEST(MetricFaultsTest, OneMessageMakesAtMostSoManyRecords) {
  MetricFaults faults;
  EXPECT_EQ(faults.Take(Errors(0, kMetricFaultsMax), 0).size(), kMetricFaultsMax);
  EXPECT_EQ(faults.Take(Errors(1000, 1000 + kMetricFaultsMax), 0).size(), kRecordsOfMessageMax);
  EXPECT_EQ(faults.active().size(), kMetricFaultsMax);
}

TEST(MetricFaultsTest, WhatTheStoreHasReplacesWhatWasKnown) {
  MetricFaults faults;
  EXPECT_EQ(faults.Take(Errors(100, 105), 0).size(), 5U);
  faults.Restore(Errors(0, 10));
  EXPECT_EQ(faults.active().size(), 10U);
  EXPECT_FALSE(faults.active().contains(FaultIdOf(Errors(100, 101).front())));
  faults.Restore(Errors(0, kMetricFaultsMax + 1));
  EXPECT_EQ(faults.active().size(), kMetricFaultsMax) << "those past the limit are passed over";
}

TEST(MetricFaultsTest, ALongErrorHasAShortIdThatDependsOnAllOfIt) {
  const std::string at(schema::kIdBytesMax, 'x');
  EXPECT_EQ(FaultIdOf(at), at);
  std::string umlauts;
  while (umlauts.size() < 500) umlauts += "\xC3\xA4";
  const std::string id = FaultIdOf(umlauts);
  EXPECT_LE(id.size(), schema::kIdBytesMax);
  EXPECT_TRUE(IsCleanUtf8(id));
  EXPECT_NE(id, FaultIdOf(umlauts + "!"));
  EXPECT_EQ(FaultIdOf(at + "x"),
            std::string(schema::kIdBytesMax - 17, 'x') + "~" + FaultIdOf(at + "x").substr(112))
      << "the beginning, then the number";
  MetricFaults faults;
  EXPECT_EQ(faults.Take({umlauts}, 0).at(0).description, umlauts);
}

TEST(MetricFaultsTest, AnIdIsTheSameInEveryProcess) {
  EXPECT_EQ(FaultIdOf(std::string(129, 'x')).substr(111), "~78d48e38324d7507");
}

}  // namespace
}  // namespace uplink::cyberwave
