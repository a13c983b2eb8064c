#include "tools/uplink-fleet/report/live_summary.h"

#include <chrono>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/manual_clock.h"

namespace uplink::synthetic {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;
using ::testing::Pair;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::string Page(int tenth, int one, int all) {
  return "# TYPE uplinkd_ack_seconds histogram\n"
         "uplinkd_ack_seconds_bucket{le=\"0.1\"} " +
         std::to_string(tenth) + "\nuplinkd_ack_seconds_bucket{le=\"1\"} " + std::to_string(one) +
         "\nuplinkd_ack_seconds_bucket{le=\"+Inf\"} " + std::to_string(all) +
         "\nuplinkd_ack_seconds_sum 3\nuplinkd_ack_seconds_count " + std::to_string(all) + "\n";
}

TEST(HistogramOf, ReadsTheBucketsOfOneMetric) {
  const Buckets buckets = HistogramOf(Page(5, 8, 10), "uplinkd_ack_seconds");
  EXPECT_EQ(buckets, (Buckets{{0.1, 5}, {1, 8}, {kInfinity, 10}}));
  EXPECT_THAT(HistogramOf(Page(5, 8, 10), "uplinkd_other_seconds"), IsEmpty());
  EXPECT_THAT(HistogramOf(Page(5, 8, 10), "ack_seconds"), IsEmpty()) << "the end of a longer name";
  EXPECT_THAT(HistogramOf("uplinkd_ack_seconds_bucket{le=\"x\"} 1", "uplinkd_ack_seconds"),
              IsEmpty());
  EXPECT_THAT(HistogramOf("uplinkd_ack_seconds_bucket{le=\"", "uplinkd_ack_seconds"), IsEmpty());
}

TEST(QuantileTest, InterpolatesWithinTheBucketOfWhatCame) {
  const Buckets before{{0.1, 5}, {1, 8}, {kInfinity, 10}};
  const Buckets after{{0.1, 9}, {1, 16}, {kInfinity, 18}};
  // Eight came: four up to 0.1, four up to 1, none above.
  EXPECT_DOUBLE_EQ(*Quantile(before, after, 0.25), 0.05);
  EXPECT_DOUBLE_EQ(*Quantile(before, after, 0.5), 0.1);
  EXPECT_DOUBLE_EQ(*Quantile(before, after, 0.75), 0.1 + 0.9 / 2);
  EXPECT_EQ(Quantile(after, after, 0.5), std::nullopt);
  EXPECT_EQ(Quantile({}, {}, 0.5), std::nullopt);
  EXPECT_DOUBLE_EQ(*Quantile({}, {{0.1, 0}, {kInfinity, 4}}, 0.5), 0.1)
      << "the highest finite bound";
}

TEST(LiveSummaryTest, SaysWhatCameSinceTheLineBefore) {
  testing::ManualClock clock;
  Shared shared;
  shared.acked_durable = 12;
  for (int i = 0; i < 3; ++i) shared.CountReject(1);
  shared.breaks = 2;
  v1::ServerStatus status;
  (*status.mutable_robots())["online"] = 4;
  (*status.mutable_uplinks())["received"] = 100;
  (*status.mutable_uplinks())["stored"] = 9;
  LiveSummary summary;
  EXPECT_THAT(LineOf(summary.Take(shared, clock.Steady(), status, Page(0, 0, 0))),
              HasSubstr("p50 -"));
  clock.Advance(std::chrono::seconds(2));
  (*status.mutable_uplinks())["received"] = 300;
  const LiveFigures figures = summary.Take(shared, clock.Steady(), status, Page(10, 10, 10));
  const std::string line = LineOf(figures);
  EXPECT_THAT(line, HasSubstr("2 s  4 online  100 messages/s"));
  EXPECT_THAT(line, HasSubstr("9 stored, 12 acked, 3 rejected, 2 breaks"));
  EXPECT_THAT(line, HasSubstr("p50 50.0 ms, p99 99.0 ms"));
  const LiveTable table = TableOf(figures, "robots send");
  EXPECT_EQ(table.heading, "robots send");
  EXPECT_THAT(
      table.rows,
      IsSupersetOf({Pair("robots online", "4"), Pair("messages per second", "100"),
                    Pair("messages received", "300"), Pair("durable messages stored", "9"),
                    Pair("durable messages acked", "12"), Pair("messages rejected", "3"),
                    Pair("streams broken off", "2"), Pair("arrival to ack, p99", "99.0 ms")}));
}

TEST(LiveSummaryTest, AServerThatIsAwayOrNewIsNoTrouble) {
  testing::ManualClock clock;
  const Shared shared;
  v1::ServerStatus status;
  (*status.mutable_uplinks())["received"] = 500;
  LiveSummary summary;
  static_cast<void>(summary.Take(shared, clock.Steady(), status, std::nullopt));
  clock.Advance(std::chrono::seconds(1));
  const LiveFigures away = summary.Take(shared, clock.Steady(), std::nullopt, std::nullopt);
  EXPECT_THAT(LineOf(away), HasSubstr("does not answer"));
  EXPECT_EQ(TableOf(away, "robots send").heading, "robots send; the server does not answer");
  EXPECT_THAT(TableOf(away, "robots send").rows, Contains(Pair("robots online", "-")));
  clock.Advance(std::chrono::seconds(1));
  (*status.mutable_uplinks())["received"] = 5;
  EXPECT_THAT(LineOf(summary.Take(shared, clock.Steady(), status, std::nullopt)),
              HasSubstr(" 0 messages/s"));
}

}  // namespace
}  // namespace uplink::synthetic
