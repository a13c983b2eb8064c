#include "tools/uplink-fleet/compare/verify_drones.h"

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

DroneEvidence Good() {
  DroneEvidence evidence;
  evidence.totals = {
      .drones = 2, .settled_drones = 2, .sent = 14, .answered = 12, .taken = 11, .wrongs = 2};
  evidence.drones_read = 2;
  evidence.before = Conservation{.received = 5, .in_flight = 0, .settled = {{"rejected", 5}}};
  evidence.after =
      Conservation{.received = 18, .in_flight = 0, .settled = {{"rejected", 7}, {"applied", 11}}};
  evidence.watch.See(evidence.after);
  return evidence;
}

std::vector<std::string> Mismatches(const DroneEvidence& evidence) {
  return MismatchesOf(VerifyDrones(evidence));
}

TEST(VerifyDrones, AGoodRunAgrees) {
  const DroneEvidence good = Good();
  EXPECT_THAT(Mismatches(good), IsEmpty());
  DroneFigures figures;
  figures.totals = good.totals;
  EXPECT_THAT(TextReport(figures, VerifyDrones(good), good.findings, Palette({})),
              HasSubstr("verification: all agree"));
  EXPECT_THAT(JsonReport(figures, VerifyDrones(good), good.findings), HasSubstr("\"ok\":true"));
}

TEST(VerifyDrones, EveryThingOfADroneHasARowOfItsOwn) {
  for (std::size_t i = kDroneThings; i < kThings; ++i) {
    DroneEvidence evidence = Good();
    evidence.findings.Differ(static_cast<Thing>(i), "rcan://a", "this", "that");
    EXPECT_THAT(Mismatches(evidence), ElementsAre(std::string(TextOf(static_cast<Thing>(i)).name)));
  }
}

TEST(VerifyDrones, WhatTheServerReceivedIsBetweenWhatWasAnsweredAndWhatWasSent) {
  for (const std::uint64_t received : {11U, 15U}) {
    DroneEvidence evidence = Good();
    evidence.after->received = 5 + received;
    evidence.after->settled["applied"] = received - 2;
    EXPECT_THAT(Mismatches(evidence), ElementsAre("received, from calls answered to calls sent"));
    evidence.restarted = true;
    evidence.before.reset();
    EXPECT_THAT(Mismatches(evidence), IsEmpty()) << "the counters began anew";
  }
}

TEST(VerifyDrones, AWrongSampleThatWasNotRejectedOnceIsFound) {
  DroneEvidence evidence = Good();
  evidence.totals.wrongs = 3;
  EXPECT_THAT(Mismatches(evidence), ElementsAre("rejected, each wrong sample once"));
}

TEST(VerifyDrones, ADroneThatWasNotAnsweredIsFound) {
  DroneEvidence evidence = Good();
  evidence.totals.settled_drones = 1;
  EXPECT_THAT(Mismatches(evidence), ElementsAre("drones with all answered"));
}

}  // namespace
}  // namespace uplink::synthetic
