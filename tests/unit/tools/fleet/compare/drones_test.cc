// What is found out about a drone: each way in which a server can be wrong.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/view/timestamps.h"
#include "tests/unit/tools/fleet/compare/drone_mirror.h"
#include "tools/uplink-fleet/compare/compare_drones.h"

namespace uplink::synthetic {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr Span kRun{kDroneStartUs / 1000, kDroneStartUs / 1000 + 3'600'000};
const DroneOptions kDrone{.seed = 3, .index = 1, .run = "run1"};

/// A run that each test makes wrong in one way. Made once: it takes most of the time.
const DroneMirror& Good() {
  static const DroneMirror good(kDrone);
  return good;
}

class Drones : public ::testing::Test {
 protected:
  [[nodiscard]] std::vector<std::string> Found() {
    Findings findings;
    CompareDroneLive(Good().drone, look, findings);
    CompareDroneRows(Good().drone, stored, findings);
    CompareDronePresence(Good().drone, stored, kRun, findings);
    std::vector<std::string> texts;
    for (const Difference& each : findings.differences()) {
      texts.push_back(std::string(TextOf(each.thing).name) + " | " + each.expected + " | " +
                      each.found);
    }
    stored = Good().stored;
    look = Good().look;
    return texts;
  }
  /// Something else in the answer for the robot.
  void Say(const std::string& what, const std::string& instead) {
    const std::size_t at = look.find(what);
    ASSERT_NE(at, std::string::npos) << what;
    look.replace(at, what.size(), instead);
  }
  /// Does it to each list of rows that a drone has, and expects that to be found.
  template <typename Damage>
  void ExpectFound(Damage damage, const std::string& how) {
    const auto one = [&](auto& rows, const char* thing) {
      ASSERT_FALSE(rows.empty()) << thing;
      damage(rows);
      EXPECT_THAT(Found(), ElementsAre(AllOf(HasSubstr(thing), HasSubstr(how))));
    };
    one(stored.robot.messages, "status texts");
    one(stored.robot.events, "events");
    one(stored.robot.faults, "alerts raised and cleared");
    one(stored.robot.active_faults, "active alerts");
    one(stored.robot.quarantine, "in quarantine");
    one(stored.requests, "operator requests, open or closed");
  }

  std::string look = Good().look;
  StoredDrone stored = Good().stored;
};

TEST_F(Drones, AServerThatIsRightAgrees) { EXPECT_THAT(Found(), IsEmpty()); }

TEST_F(Drones, AMissingRowIsFound) {
  ExpectFound([](auto& rows) { rows.pop_back(); }, "no such row");
}

TEST_F(Drones, ADoubledRowIsFound) {
  ExpectFound([](auto& rows) { rows.push_back(rows.back()); }, "times: ");
}

TEST_F(Drones, AnUnexpectedRowIsFound) {
  stored.robot.events.emplace_back().set_kind("error");
  EXPECT_THAT(Found(), ElementsAre(AllOf(HasSubstr("events"), HasSubstr("nothing like it"))));
  stored.robot.messages.emplace_back().set_message("more");
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("nothing like it")));
  stored.robot.faults.emplace_back().set_fault_id("run1.more");
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("nothing like it")));
  stored.requests.emplace_back().set_request_id("run1.more");
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("nothing like it")));
  stored.robot.quarantine.emplace_back().set_reason("malformed");
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("nothing like it")));
}

TEST_F(Drones, AlertsAndRequestsOfAnotherRunArePassedOver) {
  stored.robot.faults.emplace_back().set_fault_id("run0.alert-1");
  stored.robot.active_faults.emplace_back().set_fault_id("run0.alert-1");
  stored.requests.emplace_back().set_request_id("run0.request-1");
  EXPECT_THAT(Found(), IsEmpty());
}

TEST_F(Drones, AWrongRowIsFound) {
  stored.robot.messages.back().set_source_level("debug");
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("status texts")));
  (*stored.robot.events.back().mutable_detail()->mutable_fields())["more"].set_bool_value(true);
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("events")));
  stored.robot.faults.back().set_severity("minor");
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("alerts raised and cleared")));
  v1::OperatorRequest& request = stored.requests.front();
  if (request.has_closed_at()) {
    request.clear_closed_at();
  } else {
    request.mutable_closed_at()->set_seconds(1);
  }
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("operator requests, open or closed")));
  stored.robot.quarantine.back().set_field("other");
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("nothing like it"), HasSubstr("no such row")));
}

TEST_F(Drones, AnotherLiveValueIsFound) {
  Say("\"headingDeg\":", "\"headingDeg\":1");
  EXPECT_THAT(Found(), ElementsAre(AllOf(HasSubstr("last live values"), HasSubstr("heading: "))));
  Say("\"gpsInfo\":", "\"gpsInfos\":");
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("nothing like it"), HasSubstr("no such row")));
  Say("\"battery\":{\"0\"", "\"battery\":{\"7\"");
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("battery/7"), HasSubstr("battery/0")));
}

TEST_F(Drones, ADroneThatIsNotThereIsFound) {
  Say("online", "offline");
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("drones online")));
  Say("\"source\":\"uncrew\"", "\"source\":\"uplink\"");
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("source uplink")));
  Say("\"operatorRequestsOpen\":", "\"operatorRequestsOpen\":9");
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("counts of open requests")));
  v1::PresenceChange offline;
  offline.set_presence("offline");
  view::SetTimeMs(offline, &v1::PresenceChange::mutable_at, kRun.from_ms + 1);
  stored.robot.presence.push_back(offline);
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("offline 1 times")));
}

TEST_F(Drones, ASampleThatWasNotAnsweredMayBeStoredOrNot) {
  DroneMirror mirror(kDrone, 20);
  const auto& rows = mirror.drone.account().rows();
  const auto text = std::ranges::find_if(
      rows, [](const auto& row) { return row.second.list == DroneList::kMessages; });
  ASSERT_NE(text, rows.end());
  mirror.drone.account().Sends(text->first);
  for (int times = 1; times >= 0; --times) {
    Findings findings;
    CompareDroneRows(mirror.drone, mirror.stored, findings);
    EXPECT_EQ(findings.differences_in_all(), 0U) << times;
    mirror.stored.robot.messages.erase(mirror.stored.robot.messages.begin());
  }
}

TEST_F(Drones, AnAnswerThatIsNotDueIsFound) {
  DroneMirror mirror(kDrone, 1);
  ::uncrew::v1::PublishResponse stored_twice;
  stored_twice.set_outcome(::uncrew::v1::OUTCOME_REJECTED);
  AvatarCall call = mirror.calls.front();
  mirror.drone.account().Answered(call, stored_twice, 2, kDroneStartUs);
  Findings findings;
  CompareDroneRows(mirror.drone, mirror.stored, findings);
  EXPECT_EQ(findings.Of(Thing::kDroneAnswers).differences, 1U);
}

}  // namespace
}  // namespace uplink::synthetic
