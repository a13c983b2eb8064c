#include "tools/uplink-fleet/compare/verify.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/view/timestamps.h"
#include "tests/unit/tools/fleet/compare/mismatches.h"
#include "tools/uplink-fleet/report/json_report.h"
#include "tools/uplink-fleet/report/text_report.h"

namespace uplink::synthetic {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// A run in which everything went well: three durable messages (one expired on its way), one wrong
/// message, two live ones (a later one replaced one of them).
Evidence Good() {
  Evidence evidence;
  evidence.fleet = {.robots = 1,
                    .numbers = 6,
                    .sent = 6,
                    .durable = 3,
                    .acked = 3,
                    .expiring = 1,
                    .wrongs = 1,
                    .wrongs_by_reason = {{"missing_field", 1}},
                    .settled_robots = 1,
                    .ended_ok = 1};
  evidence.robots_read = 1;
  view::SetTimeMs(evidence.before, &v1::ServerStatus::mutable_started_at, 5);
  view::SetTimeMs(evidence.after, &v1::ServerStatus::mutable_started_at, 5);
  auto& uplinks = *evidence.after.mutable_uplinks();
  uplinks["received"] = 6;
  uplinks["stored"] = 2;
  uplinks["applied"] = 1;
  uplinks["superseded"] = 2;
  uplinks["rejected"] = 1;
  (*evidence.after.mutable_rejects_by_reason())["missing_field"] = 1;
  evidence.fleet.receivers = evidence.receivers_read = 1;
  evidence.fleet.forwarded_changes = 4;
  evidence.forwards_before = Conservation();
  evidence.forwards_after = {
      .received = 15,
      .in_flight = 1,
      .settled = {{"written", 5}, {"coalesced", 4}, {"snapshot", 3}, {"dropped", 2}}};
  return evidence;
}

std::vector<std::string> Mismatches(const Evidence& evidence) {
  return MismatchesOf(Verify(evidence));
}

TEST(Verify, AGoodRunAgrees) { EXPECT_THAT(Mismatches(Good()), IsEmpty()); }

TEST(VerifyAcks, NeedsNothingOfTheServer) {
  Evidence evidence;
  evidence.fleet = Good().fleet;
  EXPECT_THAT(MismatchesOf(VerifyAcks(evidence)), IsEmpty());
}

TEST(VerifyAcks, EachDurableMessageMustBeAcked) {
  Evidence evidence;
  evidence.fleet = Good().fleet;
  evidence.fleet.acked = 2;
  EXPECT_THAT(MismatchesOf(VerifyAcks(evidence)), ElementsAre("durable messages acked"));
}

TEST(Verify, ConservationMustHold) {
  Evidence evidence = Good();
  (*evidence.after.mutable_uplinks())["applied"] = 0;
  EXPECT_THAT(Mismatches(evidence), ElementsAre("conservation: received = the rest",
                                                "good: stored, applied or superseded"));
}

TEST(Verify, MoreIsSupersededThanCanHaveExpired) {
  Evidence evidence = Good();
  (*evidence.after.mutable_uplinks())["stored"] = 1;
  (*evidence.after.mutable_uplinks())["superseded"] = 3;
  EXPECT_THAT(Mismatches(evidence), ElementsAre("durable, stored"));
}

TEST(Verify, AMessageThatWasCountedTwice) {
  Evidence evidence = Good();
  auto& uplinks = *evidence.after.mutable_uplinks();
  uplinks["received"] = 7;
  uplinks["applied"] = 2;
  evidence.disturbed = true;
  EXPECT_THAT(Mismatches(evidence),
              ElementsAre("messages, each once", "good: stored, applied or superseded"));
  uplinks["applied"] = 1;
  uplinks["duplicate"] = 1;
  EXPECT_THAT(Mismatches(evidence), IsEmpty()) << "a repeat is no second message";
}

TEST(Verify, ARejectForAnotherReason) {
  Evidence evidence = Good();
  auto& rejects = *evidence.after.mutable_rejects_by_reason();
  rejects.clear();
  rejects["out_of_range"] = 1;
  EXPECT_THAT(Mismatches(evidence),
              ElementsAre("rejected: missing_field", "rejected: out_of_range"));
}

TEST(Verify, CountersAreComparedFromWhereTheyStood) {
  Evidence evidence = Good();
  (*evidence.before.mutable_uplinks())["received"] = 100;
  (*evidence.before.mutable_uplinks())["stored"] = 100;
  (*evidence.before.mutable_rejects_by_reason())["malformed"] = 7;
  (*evidence.after.mutable_rejects_by_reason())["malformed"] = 7;
  (*evidence.after.mutable_uplinks())["received"] = 106;
  (*evidence.after.mutable_uplinks())["stored"] = 102;
  EXPECT_THAT(Mismatches(evidence), IsEmpty());
}

TEST(Verify, RepeatsCountOnlyWhenNothingDisturbedTheStreams) {
  Evidence evidence = Good();
  evidence.fleet.sent = 7;
  EXPECT_THAT(Mismatches(evidence), ElementsAre("messages with repeats"));
  evidence.disturbed = true;
  EXPECT_THAT(Mismatches(evidence), IsEmpty());
}

TEST(Verify, AfterARestartOnlyRowsAndAcksCount) {
  Evidence evidence = Good();
  view::SetTimeMs(evidence.after, &v1::ServerStatus::mutable_started_at, 6);
  evidence.after.clear_uplinks();
  EXPECT_THAT(Mismatches(evidence), IsEmpty());
  evidence.findings.Differ(Thing::kEvents, "rcan://a", "one", "none");
  EXPECT_THAT(Mismatches(evidence), ElementsAre("events"));
}

TEST(Verify, WhatIsUnsettledBrokenOrUnreadIsAMismatch) {
  Evidence evidence = Good();
  evidence.fleet.settled_robots = 0;
  evidence.fleet.ended_ok = 0;
  evidence.fleet.acked = 2;
  evidence.rules_broken = 1;
  evidence.robots_read = 0;
  (*evidence.after.mutable_uplinks())["inFlight"] = 1;
  (*evidence.after.mutable_uplinks())["received"] = 7;
  evidence.disturbed = true;
  evidence.fleet.numbers = 7;
  EXPECT_THAT(Mismatches(evidence),
              ElementsAre("robots with all settled", "durable messages acked", "streams ended OK",
                          "protocol rules broken", "in flight at the end",
                          "good: stored, applied or superseded", "robots whose rows were read"));
}

TEST(Verify, ForwardsMustAddUp) {
  for (const char* outcome : {"written", "coalesced", "snapshot", "dropped"}) {
    Evidence evidence = Good();
    ++evidence.forwards_after->settled[outcome];
    EXPECT_THAT(Mismatches(evidence), ElementsAre("forwards due = the rest"));
  }
  Evidence evidence = Good();
  ++evidence.forwards_after->in_flight;
  EXPECT_THAT(Mismatches(evidence), ElementsAre("forwards due = the rest"));
  evidence.forwards_after.reset();
  EXPECT_THAT(Mismatches(evidence), ElementsAre("forwards due = the rest"));
}

TEST(Verify, NoMoreForwardsComeThanWereWritten) {
  Evidence evidence = Good();
  evidence.fleet.forwarded_changes = 5;
  EXPECT_THAT(Mismatches(evidence), IsEmpty());
  evidence.fleet.forwarded_changes = 6;
  EXPECT_THAT(Mismatches(evidence), ElementsAre("forwards written"));
  evidence.disturbed = true;
  EXPECT_THAT(Mismatches(evidence), IsEmpty());
  evidence = Good();
  evidence.forwards_before->settled["written"] = 2;
  EXPECT_THAT(Mismatches(evidence), ElementsAre("forwards written"));
}

TEST(Verify, AReceiverThatDoesNotShowWhatItHolds) {
  Evidence evidence = Good();
  evidence.receivers_read = 0;
  EXPECT_THAT(Mismatches(evidence), ElementsAre("receivers that showed what they hold"));
}

TEST(Verify, EveryThingOfARobotHasARowOfItsOwn) {
  for (std::size_t i = 0; i < kTwinThings; ++i) {
    Evidence evidence = Good();
    evidence.findings.Differ(static_cast<Thing>(i), "rcan://a", "this", "that");
    EXPECT_THAT(Mismatches(evidence), ElementsAre(std::string(TextOf(static_cast<Thing>(i)).name)));
  }
}

TEST(Report, SaysWhetherAllAgree) {
  const Evidence good = Good();
  EXPECT_TRUE(AllOk(Verify(good)));
  EXPECT_THAT(TextReport(RunFigures(), Verify(good), good.findings, Palette({})),
              HasSubstr("verification: all agree"));
  EXPECT_THAT(JsonReport(RunFigures(), Verify(good), good.findings), HasSubstr("\"ok\":true"));
  Evidence bad = Good();
  bad.findings.Differ(Thing::kShapes, "rcan://a", "a square", "a circle\x1b[2J");
  const std::string text = TextReport(RunFigures(), Verify(bad), bad.findings, Palette({}));
  EXPECT_THAT(text, HasSubstr("rcan://a | shapes present | a square | a circle\\x1b[2J\n"));
  EXPECT_THAT(text, HasSubstr("verification: MISMATCH"));
  const std::string json = JsonReport(RunFigures(), Verify(bad), bad.findings);
  EXPECT_THAT(json, HasSubstr("\"ok\":false"));
  EXPECT_THAT(json, HasSubstr("\"found\":\"a circle\\\\x1b[2J\""));
}

TEST(Report, ShowsNoMoreDifferencesThanOnePage) {
  Evidence bad = Good();
  for (std::size_t i = 0; i < kDifferencesMax + 5; ++i) {
    bad.findings.Differ(Thing::kEvents, "rcan://" + std::to_string(i), "", "");
  }
  EXPECT_EQ(bad.findings.differences().size(), kDifferencesMax);
  const std::string text = TextReport(RunFigures(), Verify(bad), bad.findings, Palette({}));
  EXPECT_THAT(text, HasSubstr("rcan://19 | "));
  EXPECT_THAT(text, Not(HasSubstr("rcan://20 | ")));
  EXPECT_THAT(text, HasSubstr("and 185 more"));
}

}  // namespace
}  // namespace uplink::synthetic
