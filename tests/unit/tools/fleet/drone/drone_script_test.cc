#include <algorithm>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/model/uncrew/types.h"
#include "schema/uncrew/judge.h"
#include "tests/unit/tools/fleet/compare/drone_mirror.h"
#include "tools/uplink-fleet/compare/compare_drones.h"
#include "tools/uplink-fleet/drone/script.h"

namespace uplink::synthetic {
namespace {

const DroneOptions kDrone{.seed = 7, .index = 1, .run = "run1"};

std::vector<std::string> Lines(const DroneOptions& options, int seconds) {
  DroneScript drone(options);
  std::vector<std::string> said;
  ScenarioOptions scenario;
  scenario.malformed_share = 0.2;
  for (int i = 1; i <= seconds; ++i) {
    const auto idle = [](std::size_t /*line*/) { return false; };
    for (const AvatarCall& call :
         drone.Second(kDroneStartUs + std::int64_t{i} * 1'000'000, scenario, idle)) {
      said.push_back(call.method + " " + call.request);
    }
  }
  return said;
}

TEST(DroneScript, TheSameSeedSaysTheSame) {
  EXPECT_EQ(Lines(kDrone, 30), Lines(kDrone, 30));
  DroneOptions other = kDrone;
  other.seed = 8;
  EXPECT_NE(Lines(kDrone, 30), Lines(other, 30));
  other = kDrone;
  other.index = 3;
  EXPECT_NE(Lines(kDrone, 30), Lines(other, 30));
}

TEST(DroneScript, EachTypeComesAndSamplesRepeat) {
  const std::vector<std::string> said = Lines(kDrone, 120);
  std::set<std::string> methods;
  for (const std::string& each : said) methods.insert(each.substr(0, each.find(' ')));
  for (const model::uncrew::TypeRow& row : model::uncrew::kTypeRows) {
    EXPECT_TRUE(methods.contains(std::string(row.method))) << row.method;
  }
  EXPECT_LT(std::set(said.begin(), said.end()).size(), said.size() * 9 / 10);
}

TEST(DroneScript, WhatIsRightIsTakenWholeAndWhatIsWrongIsRejectedForItsReason) {
  const DroneMirror mirror(kDrone);
  std::size_t wrongs = 0;
  for (const AvatarCall& call : mirror.calls) {
    const uncrew::Judgement judged =
        uncrew::Judge(*model::uncrew::TypeOfMethod(call.method), call.request);
    EXPECT_TRUE(judged.dropped.empty()) << call.method;
    const bool wrong = call.due.outcomes.Has(::uncrew::v1::OUTCOME_REJECTED);
    ASSERT_EQ(judged.rejection() != nullptr, wrong) << call.method;
    if (!wrong) continue;
    ++wrongs;
    EXPECT_EQ(judged.rejection()->reason, call.due.reason) << call.method << call.due.field;
    EXPECT_EQ(judged.rejection()->field, call.due.field) << call.method;
  }
  EXPECT_GT(wrongs, DroneWrongKinds());
}

TEST(DroneScript, ManyDronesAgreeWithAServerThatIsRight) {
  for (std::size_t index = 0; index < 8; ++index) {
    const DroneMirror mirror({.seed = 11, .index = index, .run = "r"}, 60);
    Findings findings;
    CompareDroneLive(mirror.drone, mirror.look, findings);
    CompareDroneRows(mirror.drone, mirror.stored, findings);
    for (const Difference& each : findings.differences()) {
      ADD_FAILURE() << "drone " << index << ": " << TextOf(each.thing).name << " | "
                    << each.expected << " | " << each.found;
    }
  }
}

TEST(DroneScript, ALineThatIsBusyGetsNothingThatMustBeAnswered) {
  DroneScript drone(kDrone);
  const auto busy = [](std::size_t /*line*/) { return true; };
  for (int i = 1; i <= 10; ++i) {
    for (const AvatarCall& call :
         drone.Second(kDroneStartUs + std::int64_t{i} * 1'000'000, {}, busy)) {
      EXPECT_TRUE(call.live) << call.method;
    }
  }
  EXPECT_TRUE(drone.account().rows().empty());
}

TEST(DroneAccount, KnowsWhatIsNotAnsweredAndHowLongTheDroneWasSilent) {
  DroneAccount account;
  const AvatarCall call{.number = 1, .method = "PublishHeading", .live = true, .due = {kApplies}};
  account.Sends(1);
  EXPECT_TRUE(account.Waits(1));
  ::uncrew::v1::PublishResponse answer;
  answer.set_outcome(::uncrew::v1::OUTCOME_SUPERSEDED);
  account.Answered(call, answer, 2, 5'000'000);
  EXPECT_FALSE(account.Waits(1));
  EXPECT_EQ(account.undue_answers(), 0U) << "the first one may have arrived";
  account.Answered(call, answer, 1, 9'000'000);
  EXPECT_EQ(account.longest_silence_us(), 4'000'000);
  EXPECT_EQ(account.undue_answers(), 1U);
  EXPECT_EQ(account.first_due(), "PublishHeading 1: OUTCOME_APPLIED");
}

}  // namespace
}  // namespace uplink::synthetic
