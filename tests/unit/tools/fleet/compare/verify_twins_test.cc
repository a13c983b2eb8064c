#include "tools/uplink-fleet/compare/verify_twins.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/tools/fleet/compare/mismatches.h"
#include "tools/uplink-fleet/report/json_report.h"
#include "tools/uplink-fleet/report/text_report.h"

namespace uplink::synthetic {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

TwinEvidence Good() {
  TwinEvidence evidence;
  evidence.totals = {.twins = 2,
                     .settled_twins = 2,
                     .published = 30,
                     .published_qos1 = 10,
                     .acked = 10,
                     .refused = 0,
                     .pings = 3,
                     .pongs = 2};
  evidence.twins_read = 2;
  evidence.before = Conservation{.received = 5, .in_flight = 0, .settled = {{"stored", 5}}};
  evidence.after =
      Conservation{.received = 20, .in_flight = 0, .settled = {{"stored", 12}, {"applied", 8}}};
  evidence.watch.See(evidence.after);
  return evidence;
}

std::vector<std::string> Mismatches(const TwinEvidence& evidence) {
  return MismatchesOf(VerifyTwins(evidence));
}

TEST(VerifyTwins, AGoodRunAgrees) {
  EXPECT_THAT(Mismatches(Good()), IsEmpty());
  const TwinEvidence good = Good();
  TwinFigures figures;
  figures.totals = good.totals;
  const std::string text = TextReport(figures, VerifyTwins(good), good.findings, Palette({}));
  EXPECT_THAT(text, HasSubstr("verification: all agree"));
  EXPECT_THAT(JsonReport(figures, VerifyTwins(good), good.findings), HasSubstr("\"ok\":true"));
}

TEST(VerifyTwins, EveryThingOfATwinHasARowOfItsOwn) {
  for (std::size_t i = kTwinThings; i < kDroneThings; ++i) {
    TwinEvidence evidence = Good();
    evidence.findings.Differ(static_cast<Thing>(i), "rcan://a", "this", "that");
    EXPECT_THAT(Mismatches(evidence), ElementsAre(std::string(TextOf(static_cast<Thing>(i)).name)));
  }
}

TEST(VerifyTwins, ConservationMustHoldAtEachScrape) {
  TwinEvidence evidence = Good();
  evidence.watch.See(Conservation{.received = 2, .in_flight = 0, .settled = {{"stored", 1}}});
  EXPECT_THAT(Mismatches(evidence), ElementsAre("scrapes in which received = the rest"));
  evidence = Good();
  evidence.after->settled["stored"] = 11;
  EXPECT_THAT(Mismatches(evidence), ElementsAre("received = the rest"));
  evidence = Good();
  evidence.after.reset();
  EXPECT_THAT(Mismatches(evidence), ElementsAre("received = the rest"));
}

TEST(VerifyTwins, LessWasReceivedThanAcked) {
  TwinEvidence evidence = Good();
  evidence.before->received = 11;
  EXPECT_THAT(Mismatches(evidence), ElementsAre("received, at least what was acked"));
  evidence.restarted = true;
  EXPECT_THAT(Mismatches(evidence), IsEmpty()) << "the counters began anew";
}

TEST(VerifyTwins, WhatTheBrokerDidNotTake) {
  TwinEvidence evidence = Good();
  evidence.totals.settled_twins = 1;
  evidence.totals.acked = 9;
  evidence.totals.refused = 1;
  evidence.totals.pongs = 0;
  EXPECT_THAT(Mismatches(evidence), ElementsAre("twins with all acked", "published at QoS 1, acked",
                                                "refused by the broker", "pings answered"));
}

TEST(VerifyTwins, ADifferenceOfATwinIsAMismatch) {
  TwinEvidence evidence = Good();
  evidence.findings.Differ(Thing::kTwinEvents, "rcan://x", "once", "twice");
  EXPECT_THAT(Mismatches(evidence), ElementsAre("events"));
  const std::string text =
      TextReport(TwinFigures(), VerifyTwins(evidence), evidence.findings, Palette({}));
  EXPECT_THAT(text, HasSubstr("rcan://x | events | once | twice"));
  EXPECT_THAT(text, HasSubstr("verification: MISMATCH"));
}

}  // namespace
}  // namespace uplink::synthetic
