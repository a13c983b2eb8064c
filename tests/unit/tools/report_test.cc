#include "tools/uplink-fleet/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::synthetic {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

RunFigures Figures() {
  RunFigures figures;
  figures.robots = 3;
  figures.seconds = 10;
  figures.sent = 1000;
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
                    HasSubstr("server: 0.02 s of CPU, 0 % of a core, 20.0 us a message; 64 MiB"),
                    HasSubstr("fleet: 0.50 s of CPU, 5 % of a core, 500.0 us a message; 32 MiB"),
                    Not(HasSubstr("too slow"))));
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
