// What is found out about a twin: each way in which a server can be wrong.
#include <algorithm>
#include <functional>
#include <string>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/view/timestamps.h"
#include "tests/unit/tools/fleet/compare/twin_mirror.h"
#include "tools/uplink-fleet/compare/compare_twin_live.h"
#include "tools/uplink-fleet/compare/compare_twin_rows.h"

namespace uplink::synthetic {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr Span kRun{kTwinStartUs / 1000, kTwinStartUs / 1000 + 3'600'000};

/// A run that each test makes wrong in one way. Made once: it takes most of the time.
const TwinMirror& Good() {
  static const TwinMirror good({.seed = 3, .index = 2, .run = "run1", .prefix = ""}, 3000);
  return good;
}

class Twins : public ::testing::Test {
 protected:
  [[nodiscard]] std::vector<std::string> Found() const {
    Findings findings;
    CompareTwinLive(Good().twin, look, findings);
    std::vector<v1::Quarantined> of_nobody = nobody;
    CompareTwinRows(Good().twin, stored, of_nobody, findings);
    CompareTwinPresence(Good().twin, stored, kRun, findings);
    std::vector<std::string> texts;
    for (const Difference& each : findings.differences()) {
      texts.push_back(std::string(TextOf(each.thing).name) + " | " + each.expected + " | " +
                      each.found);
    }
    return texts;
  }
  [[nodiscard]] StoredRobot& Real() { return stored.robots[0]; }

  /// Something else in the answer for the real robot.
  void Say(const std::string& what, const std::string& instead) {
    const std::size_t at = look[0].find(what);
    ASSERT_NE(at, std::string::npos) << what;
    look[0].replace(at, what.size(), instead);
  }

  TwinLook look = Good().look;
  StoredTwin stored = Good().stored;
  std::vector<v1::Quarantined> nobody = Good().nobody;
};

TEST_F(Twins, AServerThatIsRightAgrees) { EXPECT_THAT(Found(), IsEmpty()); }

TEST_F(Twins, AllKindsOfRowsAreThere) {
  EXPECT_FALSE(Real().events.empty());
  EXPECT_FALSE(Real().messages.empty());
  EXPECT_FALSE(Real().runs.empty());
  EXPECT_FALSE(Real().faults.empty());
  EXPECT_FALSE(Real().active_faults.empty());
  EXPECT_FALSE(Real().quarantine.empty());
  EXPECT_FALSE(stored.robots[1].events.empty());
  EXPECT_FALSE(stored.scopes.empty());
  EXPECT_FALSE(nobody.empty());
}

// Each list of rows: one is missing, one is there twice, one belongs to no twin.
template <typename Rows>
void Lose(Rows& rows) {
  rows.erase(rows.begin() + static_cast<std::ptrdiff_t>(rows.size() / 2));
}
template <typename Rows>
void Double(Rows& rows) {
  rows.push_back(rows[rows.size() / 2]);
}

TEST_F(Twins, AMissingRowIsFound) {
  Lose(Real().events);
  EXPECT_THAT(Found(), ElementsAre(AllOf(HasSubstr("events"), HasSubstr("no such row"))));
  stored = Good().stored;
  Lose(Real().messages);
  EXPECT_THAT(Found(), ElementsAre(AllOf(HasSubstr("log lines"), HasSubstr("no such row"))));
  stored = Good().stored;
  Lose(stored.scopes);
  EXPECT_THAT(Found(), ElementsAre(AllOf(HasSubstr("environments"), HasSubstr("no such row"))));
  stored = Good().stored;
  Lose(Real().runs);
  EXPECT_THAT(Found(), ElementsAre(AllOf(HasSubstr("mission runs"), HasSubstr("no such row"))));
  stored = Good().stored;
  Lose(Real().faults);
  EXPECT_THAT(Found(), ElementsAre(AllOf(HasSubstr("errors raised"), HasSubstr("no such row"))));
  stored = Good().stored;
  Real().active_faults.clear();
  EXPECT_THAT(Found().front(), AllOf(HasSubstr("active errors"), HasSubstr("no such row")));
  stored = Good().stored;
  Lose(nobody);
  EXPECT_THAT(Found(), ElementsAre(AllOf(HasSubstr("quarantine"), HasSubstr("no such row"))));
}

TEST_F(Twins, ADoubledRowIsFound) {
  Double(Real().events);
  EXPECT_THAT(Found(), ElementsAre(AllOf(HasSubstr("events"), HasSubstr("2 times"))));
  stored = Good().stored;
  Double(Real().messages);
  EXPECT_THAT(Found(), ElementsAre(AllOf(HasSubstr("log lines"), HasSubstr("2 times"))));
  stored = Good().stored;
  Double(stored.scopes);
  EXPECT_THAT(Found(), ElementsAre(AllOf(HasSubstr("environments"), HasSubstr("2 times"))));
  stored = Good().stored;
  Double(Real().faults);
  EXPECT_THAT(Found(), ElementsAre(AllOf(HasSubstr("errors raised"), HasSubstr("2 times"))));
  stored = Good().stored;
  Double(Real().quarantine);
  EXPECT_THAT(Found(), ElementsAre(AllOf(HasSubstr("quarantine"), HasSubstr("2 times"))));
  stored = Good().stored;
  v1::MissionRun& run = Real().runs.front();
  run.set_updates(run.updates() + 1);
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("mission updates")));
}

TEST_F(Twins, AWrongRowIsFound) {
  view::SetTimeMs(Real().events.front(), &v1::Event::mutable_sampled_at, 1);
  EXPECT_THAT(Found(), ElementsAre(AllOf(HasSubstr("events"), HasSubstr("number "))));
  stored = Good().stored;
  (*Real().events.front().mutable_detail()->mutable_fields())["more"].set_bool_value(true);
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("events")));
  stored = Good().stored;
  Real().messages.front().set_level("fatal");
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("log lines")));
  stored = Good().stored;
  stored.scopes.front().set_type("other");
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("environments")));
  stored = Good().stored;
  Real().runs.front().set_status("ready2");
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("mission runs")));
  stored = Good().stored;
  Real().faults.front().set_source("robot");
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("errors raised")));
  stored = Good().stored;
  Real().quarantine.front().set_reason("malformed2");
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("quarantine")));
}

TEST_F(Twins, ARowOfTheOtherRobotIsFound) {
  stored.robots[1].events.push_back(Real().events.front());
  Real().events.erase(Real().events.begin());
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("no such row"), HasSubstr("nothing like it")));
}

TEST_F(Twins, RowsOfAnotherRunArePassedOver) {
  const TwinMirror other({.seed = 3, .index = 2, .run = "run0", .prefix = ""}, 200);
  const auto append = [](auto& rows, const auto& more) {
    rows.insert(rows.end(), more.begin(), more.end());
  };
  append(Real().events, other.stored.robots[0].events);
  append(Real().messages, other.stored.robots[0].messages);
  append(Real().faults, other.stored.robots[0].faults);
  append(Real().runs, other.stored.robots[0].runs);
  append(stored.scopes, other.stored.scopes);
  append(nobody, other.nobody);
  EXPECT_THAT(Found(), IsEmpty());
}

TEST_F(Twins, ARowWhosePayloadTheServerDroppedStandsForTheMessageThatItDescribes) {
  Real().quarantine.front().clear_payload();
  ASSERT_FALSE(nobody.empty());
  nobody.front().clear_payload();
  EXPECT_THAT(Found(), IsEmpty());
  v1::Quarantined twice = Real().quarantine.front();
  Real().quarantine.push_back(twice);
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("only what is wrong on purpose")));
  Real().quarantine.clear();
  EXPECT_THAT(Found(), Contains(HasSubstr("no such row")));
}

TEST_F(Twins, AGoodMessageInQuarantineIsFound) {
  v1::Quarantined row = Real().quarantine.front();
  row.set_payload(MarkOf(Good().twin.options(), Good().twin.account().rows().begin()->first));
  Real().quarantine.push_back(row);
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("nothing like it")));
  // A live message has no mark.
  Real().quarantine.back().set_payload("{\"position\":{}}");
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("only what is wrong on purpose")));
}

TEST_F(Twins, AnEarlierLiveValueIsFound) {
  // The last position but one, where the last one was.
  const auto position = [](const Publication& each) {
    return each.topic.ends_with("/position") &&
           each.payload.find("\"source_type\":\"edge\"") != std::string::npos;
  };
  const auto& published = Good().published;
  const auto late = std::find_if(published.rbegin(), published.rend(), position);
  const auto last = std::find_if(late + 1, published.rend(), position);
  const auto before = std::find_if(last + 1, published.rend(), position);
  ASSERT_NE(before, published.rend());
  const auto place = [](const Publication& each) {
    const std::size_t at = each.payload.find("{\"x\"");
    return each.payload.substr(at, each.payload.find('}', at) - at);
  };
  Say(place(*last), place(*before));
  EXPECT_THAT(Found(), ElementsAre(AllOf(HasSubstr("last live values"), HasSubstr("position"))));
}

TEST_F(Twins, LiveValuesThatWereNeverSentAreFound) {
  Say("\"joints\":{", "\"joints\":{\"tele\":{\"elbow\":{\"position\":1}},");
  EXPECT_THAT(Found(), ElementsAre(AllOf(HasSubstr("nothing like it"),
                                         HasSubstr("joints/tele/elbow/position"))));
  look = Good().look;
  Say("\"gps\"", "\"gps2\"");
  EXPECT_THAT(Found(), ElementsAre(AllOf(HasSubstr("gps"), HasSubstr("no such row"))));
}

TEST_F(Twins, ASecretThatShowsIsFound) {
  Say("\"cyberwave\":{", "\"cyberwave\":{\"leak\":\"" + std::string(kSecret) + "\",");
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("secret")));
}

TEST_F(Twins, AWrongSessionIsFound) {
  const std::string id = "\"" + Good().twin.ids().driver_session + "\":{\"connected\":true";
  Say(id, id.substr(0, id.size() - 4) + "false");
  EXPECT_THAT(Found(), ElementsAre(AllOf(HasSubstr("sessions"), HasSubstr("connected no"))));
}

TEST_F(Twins, ARobotThatIsNotThereIsFound) {
  Say("online", "offline");
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("robots online")));
  look = Good().look;
  Say("\"source\":\"cyberwave\"", "\"source\":\"uplink\"");
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("source uplink")));
  look[1].clear();
  EXPECT_GT(Found().size(), 5U) << "nothing of the simulated robot is there";
}

TEST_F(Twins, PresenceThatWentAwayIsFound) {
  v1::PresenceChange offline;
  offline.set_presence("offline");
  view::SetTimeMs(offline, &v1::PresenceChange::mutable_at, kRun.from_ms + 1);
  Real().presence.push_back(offline);
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("offline 1 times")));
  Real().presence = {offline};
  EXPECT_THAT(Found(), ElementsAre(HasSubstr("offline at last")));
}

TEST(Delivery, SaysHowOftenSomethingMayBeThere) {
  for (const auto& [delivery, min, max] : {std::tuple(Delivery::kOnce, 1U, std::uint64_t{1}),
                                           std::tuple(Delivery::kOnceOrMore, 1U, kAnyTimes),
                                           std::tuple(Delivery::kAtMostOnce, 0U, std::uint64_t{1}),
                                           std::tuple(Delivery::kUnknown, 0U, kAnyTimes)}) {
    EXPECT_EQ(TimesOf(delivery).min, min);
    EXPECT_EQ(TimesOf(delivery).max, max);
  }
}

}  // namespace
}  // namespace uplink::synthetic
