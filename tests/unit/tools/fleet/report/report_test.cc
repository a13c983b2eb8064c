#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tools/uplink-fleet/report/json_report.h"
#include "tools/uplink-fleet/report/text_report.h"

namespace uplink::synthetic {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const Palette kPlain({.updates = false, .colours = false});

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
  EXPECT_THAT(TextReport(figures, {}, {}, kPlain),
              AllOf(HasSubstr("5 connections"), HasSubstr("2 takeovers"),
                    HasSubstr("\ndurable, due to acked | 4.00 | 4.00 | 4.00 |  4.00 | 4.00 | "
                              "1 messages\n"),
                    Not(HasSubstr("live, due")),
                    HasSubstr("\nserver | 0.02 s |       0 % |     20.0 us | 64 MiB\n"),
                    HasSubstr("\nfleet  | 0.50 s |       5 % |    500.0 us | 32 MiB\n"),
                    Not(HasSubstr("too slow"))));
}

TEST(ReportTest, WhatBecameOfMessagesIsSaid) {
  RunFigures figures = Figures();
  figures.judged = 1499;
  figures.rejects_by_reason = {{"malformed", 3}, {"rateLimited", 2}};
  figures.only_moving = 4;
  figures.latencies.gave_way.Record(std::chrono::seconds(30));
  EXPECT_THAT(
      TextReport(figures, {}, {}, kPlain),
      AllOf(HasSubstr("messages   1500 sent (0 again), 1499 judged, 0 live acked"),
            HasSubstr("live that gave way unacked, due to given up | 30000.0 |"),
            HasSubstr("rejected   3 malformed, 2 rateLimited\n"),
            HasSubstr("4 robots had as much to remember as they may, and only moved then\n")));
  EXPECT_THAT(JsonReport(figures, {}, {}),
              AllOf(HasSubstr(R"("rejectsByReason":{)"), HasSubstr(R"("malformed":3)"),
                    HasSubstr(R"("rateLimited":2)"), HasSubstr(R"("judged":1499)"),
                    HasSubstr(R"("onlyMoving":4)"), HasSubstr(R"("liveGaveWay":{)")));
}

TEST(ReportTest, AServerElsewhereAndAFleetThatIsTheLimitAreSeen) {
  RunFigures figures = Figures();
  figures.skipped_ticks = 7;
  EXPECT_THAT(TextReport(figures, {}, {}, kPlain),
              AllOf(Not(HasSubstr("\nserver ")), HasSubstr("too slow: 7 ticks were left out")));
}

TEST(ReportTest, ALongListGoesOnBelowItsBeginning) {
  RunFigures figures = Figures();
  for (const char* reason : {"duplicate_key", "malformed", "missing_field", "not_finite"}) {
    figures.rejects_by_reason[reason] = 1000;
  }
  figures.rejects_by_reason["out_of_range"] = 1;
  EXPECT_THAT(TextReport(figures, {}, {}, kPlain),
              HasSubstr("rejected   1000 duplicate_key, 1000 malformed, 1000 missing_field,\n"
                        "           1000 not_finite, 1 out_of_range\n"));
}

TEST(ReportTest, TheVerificationIsAnAlignedTable) {
  const std::vector<CheckRow> rows{
      {.what = "robots online", .fleet = "50", .server = "50", .store = "", .ok = true, .note = ""},
      {.what = "in flight", .fleet = "0", .server = "3", .store = "", .ok = false, .note = "why"}};
  EXPECT_THAT(TextReport(Figures(), rows, {}, kPlain),
              HasSubstr("what          | fleet | server | store |\n"
                        "--------------+-------+--------+-------+---------\n"
                        "robots online |    50 |     50 |       | ok\n"
                        "in flight     |     0 |      3 |       | MISMATCH\n"
                        "    why\n"
                        "\n"
                        "verification: MISMATCH\n"));
}

TEST(ReportTest, ColoursSayWhatAgrees) {
  const Palette coloured({.updates = true, .colours = true});
  CheckRow row{.what = "online", .fleet = "1", .server = "1", .store = "", .ok = true, .note = ""};
  const std::string good = TextReport(Figures(), {row}, {}, coloured);
  EXPECT_THAT(good, AllOf(HasSubstr("| \x1b[32mok\x1b[0m\n"),
                          HasSubstr("\x1b[32mverification: all agree\x1b[0m\n")));
  row.ok = false;
  const std::string bad = TextReport(Figures(), {row}, {}, coloured);
  EXPECT_THAT(bad, AllOf(HasSubstr("| \x1b[1;31mMISMATCH\x1b[0m\n"),
                         HasSubstr("\x1b[1;31mverification: MISMATCH\x1b[0m\n")));
  EXPECT_THAT(TextReport(Figures(), {row}, {}, kPlain), Not(HasSubstr("\x1b")));
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
