#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tools/uplink-fleet/report/json_report.h"
#include "tools/uplink-fleet/report/text_report.h"

namespace uplink::synthetic {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

RunFigures Figures() {
  RunFigures figures;
  figures.robots = 3;
  figures.seconds = 10;
  figures.sent = 1500;
  figures.sent_while_measured = 1000;
  figures.connects = 5;
  figures.takeovers = 2;
  figures.latencies.durable.Record(std::chrono::milliseconds(4));
  figures.own = {.cpu_seconds = 0.5, .rss_bytes = 32 << 20};
  return figures;
}

TEST(ReportTest, TheTextHoldsLatencyAndCost) {
  RunFigures figures = Figures();
  figures.server = {.cpu_seconds = 0.02, .rss_bytes = 64 << 20};
  EXPECT_THAT(TextReport(figures, {}, {}),
              AllOf(HasSubstr("5 connections"), HasSubstr("2 takeovers"),
                    HasSubstr("durable, due to acked: p50 4.00 ms, p90 4.00 ms"),
                    HasSubstr("max 4.00 ms (1 messages)"), Not(HasSubstr("live, due")),
                    HasSubstr("server: 0.02 s of CPU, 0 % of a core, 20.0 us per message; 64 MiB"),
                    HasSubstr("fleet: 0.50 s of CPU, 5 % of a core, 500.0 us per message; 32 MiB"),
                    Not(HasSubstr("too slow"))));
}

TEST(ReportTest, WhatBecameOfMessagesIsSaid) {
  RunFigures figures = Figures();
  figures.judged = 1499;
  figures.rejects_by_reason = {{"malformed", 3}, {"rateLimited", 2}};
  figures.only_moving = 4;
  figures.latencies.gave_way.Record(std::chrono::seconds(30));
  EXPECT_THAT(
      TextReport(figures, {}, {}),
      AllOf(HasSubstr("1500 messages sent (0 again), 1499 judged, 0 live acked"),
            HasSubstr("live that gave way unacked, due to given up: p50 30000.00 ms"),
            HasSubstr("rejected malformed: 3\nrejected rateLimited: 2\n"),
            HasSubstr("4 robots had as much to remember as they may, and only moved then\n")));
  EXPECT_THAT(JsonReport(figures, {}, {}),
              AllOf(HasSubstr(R"("rejectsByReason":{)"), HasSubstr(R"("malformed":3)"),
                    HasSubstr(R"("rateLimited":2)"), HasSubstr(R"("judged":1499)"),
                    HasSubstr(R"("onlyMoving":4)"), HasSubstr(R"("liveGaveWay":{)")));
}

TEST(ReportTest, AServerElsewhereAndAFleetThatIsTheLimitAreSeen) {
  RunFigures figures = Figures();
  figures.skipped_ticks = 7;
  EXPECT_THAT(TextReport(figures, {}, {}),
              AllOf(Not(HasSubstr("server:")), HasSubstr("too slow: 7 ticks were left out")));
}

TEST(ReportTest, TheJsonHoldsTheSame) {
  RunFigures figures = Figures();
  figures.server = {.cpu_seconds = 0.25, .rss_bytes = 4096};
  const std::string json = JsonReport(figures, {}, {});
  EXPECT_THAT(json, AllOf(HasSubstr(R"("connects":5)"), HasSubstr(R"("takeovers":2)"),
                          HasSubstr(R"("skippedTicks":0)"), HasSubstr(R"("p99.9":4)"),
                          HasSubstr(R"("cpuSeconds":0.25)"), HasSubstr(R"("rssBytes":4096)")));
}

}  // namespace
}  // namespace uplink::synthetic
