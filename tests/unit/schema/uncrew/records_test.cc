// What is stored of a drone's sample, given the one before it.
#include "schema/uncrew/records.h"

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/schema/uncrew/requests.h"
#include "tests/unit/schema/uncrew/samples.h"

namespace uplink::uncrew {
namespace {

namespace uc = model::uncrew;
using test::RequestOf;
using test::Type;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// What samples of one type store, one after the other, by what a store remembers of them.
class Stored {
 public:
  explicit Stored(Type type) : type_(type) {}

  std::vector<DurableRecord> After(const std::string& text) {
    const std::string request = RequestOf(type_, "metadata { sampled_at_unix_us: 9000 } " + text);
    const auto before = Recall(type_, memory_);
    std::vector<DurableRecord> records =
        Records::Of(Judge(type_, request), before ? &before->value : nullptr);
    if (!records.empty()) memory_ = MemoryOf(type_, request);
    return records;
  }

  /// Each event as `kind detail`.
  std::vector<std::string> EventsAfter(const std::string& text) {
    std::vector<std::string> events;
    for (const DurableRecord& record : After(text)) {
      const auto& event = std::get<model::EventTelemetry>(std::get<model::Record>(record).body());
      EXPECT_EQ(event.unix_time_ms, 9);
      const auto& named = std::get<model::NamedEvent>(event.kind);
      events.push_back(named.kind + " " + named.detail_json);
    }
    return events;
  }

  /// Each fault as `id raised` or `id cleared`.
  std::vector<std::string> FaultsAfter(const std::string& text) {
    std::vector<std::string> faults;
    for (const DurableRecord& record : After(text)) {
      const auto& fault = std::get<model::Fault>(std::get<model::Record>(record).body());
      EXPECT_EQ(fault.source, "uncrew");
      faults.push_back(fault.fault_id + (fault.active ? " raised" : " cleared"));
    }
    return faults;
  }

  std::vector<std::string> RequestsAfter(const std::string& text) {
    std::vector<std::string> requests;
    for (const DurableRecord& record : After(text)) {
      const auto& request = std::get<model::OperatorRequest>(record);
      EXPECT_EQ(request.unix_time_ms, 9);
      requests.push_back(request.request_id + (request.open ? " open" : " closed"));
    }
    return requests;
  }

 private:
  Type type_;
  std::string memory_;
};

TEST(Records, AreNoneOfLiveSamples) {
  EXPECT_THAT(Stored(Type::kBattery).After("battery { remaining_percent: 50 }"), IsEmpty());
  EXPECT_EQ(MemoryOf(Type::kBattery, "x"), "");
  EXPECT_EQ(MemoryOf(Type::kStatusText, "x"), "");
  EXPECT_EQ(MemoryOf(Type::kAlerts, "x"), "x");
}

TEST(Records, AreNoneOfRejectedSamples) {
  EXPECT_THAT(Stored(Type::kError).After("error {}"), IsEmpty());
}

TEST(Records, TellAChangeOfModeOnce) {
  Stored armed(Type::kArmed);
  EXPECT_THAT(armed.EventsAfter("armed { is_armed: false }"), ElementsAre(R"(armed {"to":false})"));
  EXPECT_THAT(armed.EventsAfter("armed { is_armed: false }"), IsEmpty());
  EXPECT_THAT(armed.EventsAfter("armed {}"), IsEmpty());
  EXPECT_THAT(armed.EventsAfter("armed { is_armed: true }"),
              ElementsAre(R"(armed {"from":false,"to":true})"));
  Stored mode(Type::kFlightMode);
  EXPECT_THAT(mode.EventsAfter("flight_mode { mode: FLIGHT_MODE_HOLD }"),
              ElementsAre(R"(flightMode {"to":"hold"})"));
  EXPECT_THAT(mode.EventsAfter("flight_mode { mode: 77 }"),
              ElementsAre(R"(flightMode {"from":"hold","to":"unrecognized_77"})"));
}

TEST(Records, TellNoChangeOfAModesDetail) {
  Stored mode(Type::kUncrewFlightMode);
  EXPECT_THAT(mode.EventsAfter("uncrew_flight_mode { mode: 'A' detail: '1' }"),
              ElementsAre(R"(uncrewFlightMode {"to":"A"})"));
  EXPECT_THAT(mode.EventsAfter("uncrew_flight_mode { mode: 'A' detail: '2' }"), IsEmpty());
  EXPECT_THAT(mode.EventsAfter("uncrew_flight_mode { detail: '3' }"), IsEmpty());
  EXPECT_THAT(mode.EventsAfter("uncrew_flight_mode { mode: 'B' }"),
              ElementsAre(R"(uncrewFlightMode {"from":"A","to":"B"})"));
}

TEST(Records, TellTheMissionItemWhole) {
  Stored item(Type::kCurrentMissionItem);
  EXPECT_THAT(item.EventsAfter("current_mission_item { current: 0 total: 2 mission_id: 'm' }"),
              ElementsAre(R"(missionItem {"to":{"current":0,"total":2,"missionId":"m"}})"));
  EXPECT_THAT(item.EventsAfter("current_mission_item { current: 1 total: 2 mission_id: 'm' }"),
              ElementsAre(R"(missionItem {"from":{"current":0,"total":2,"missionId":"m"},)"
                          R"("to":{"current":1,"total":2,"missionId":"m"}})"));
}

TEST(Records, TellErrorsConnectionsAndResultsAsEvents) {
  EXPECT_THAT(Stored(Type::kError).EventsAfter("error { text: 'hot' code: 'E7' }"),
              ElementsAre(R"(error {"code":"E7","text":"hot"})"));
  EXPECT_THAT(Stored(Type::kConnectionEvent)
                  .EventsAfter("connection_event { kind: KIND_CONNECTED text: 'up' }"),
              ElementsAre(R"(connection {"kind":"connected","text":"up"})"));
  EXPECT_THAT(
      Stored(Type::kCommandResult).EventsAfter("command_id: 'c' status { state: STATE_STARTED }"),
      ElementsAre(R"(commandResult {"commandId":"c","state":"started"})"));
}

TEST(Records, TellAStatusTextByItsLevel) {
  const auto levels = [](const std::string& type) {
    const auto records =
        Stored(Type::kStatusText).After("status_text { text: 't' type: " + type + " }");
    const auto& message = std::get<model::Message>(std::get<model::Record>(records.at(0)).body());
    return std::pair(message.level, message.source_level);
  };
  using model::MessageLevel;
  EXPECT_EQ(levels("STATUS_TEXT_TYPE_DEBUG"), std::pair(MessageLevel::kInfo, std::string("debug")));
  EXPECT_EQ(levels("STATUS_TEXT_TYPE_NOTICE"),
            std::pair(MessageLevel::kInfo, std::string("notice")));
  EXPECT_EQ(levels("STATUS_TEXT_TYPE_WARNING"),
            std::pair(MessageLevel::kWarn, std::string("warning")));
  EXPECT_EQ(levels("STATUS_TEXT_TYPE_ERROR"),
            std::pair(MessageLevel::kError, std::string("error")));
  EXPECT_EQ(levels("STATUS_TEXT_TYPE_EMERGENCY"),
            std::pair(MessageLevel::kError, std::string("emergency")));
  EXPECT_EQ(levels("9"), std::pair(MessageLevel::kInfo, std::string("unrecognized_9")));
}

TEST(Records, RaiseAlertsThatAreNewAndClearThoseThatAreGone) {
  Stored alerts(Type::kAlerts);
  EXPECT_THAT(alerts.FaultsAfter("alerts {}"), IsEmpty());
  EXPECT_THAT(alerts.FaultsAfter("alerts { alerts { battery {} } }"),
              ElementsAre("battery/0 raised"));
  EXPECT_THAT(alerts.FaultsAfter("alerts { alerts { battery { condition: 'x' } } }"), IsEmpty());
  EXPECT_THAT(alerts.FaultsAfter("alerts { alerts { alert_id: 'b' flight_termination {} } }"),
              ElementsAre("battery/0 cleared", "b raised"));
  EXPECT_THAT(alerts.FaultsAfter(""), IsEmpty()) << "a set that is missing clears nothing";
  EXPECT_THAT(alerts.FaultsAfter("alerts {}"), ElementsAre("b cleared"));
}

TEST(Records, SayWhatAnAlertIs) {
  const auto records = Stored(Type::kAlerts).After(test::kSamples[23].text.data());
  ASSERT_EQ(records.size(), 3U);
  const auto fault = [&](std::size_t i) {
    return std::get<model::Fault>(std::get<model::Record>(records[i]).body());
  };
  EXPECT_EQ(fault(0), (model::Fault{.unix_time_ms = 5,
                                    .fault_id = "battery/2",
                                    .source = "uncrew",
                                    .severity = model::FaultSeverity::kMajor,
                                    .active = true,
                                    .category = "battery",
                                    .description = "cell low",
                                    .suggested_action = {}}));
  EXPECT_EQ(fault(1).description, "20 % left");
  EXPECT_EQ(fault(1).unix_time_ms, 9);
  EXPECT_EQ(fault(2).severity, model::FaultSeverity::kCritical);
  EXPECT_EQ(fault(2).description, "parachute");
}

TEST(Records, OpenRequestsThatAreNewAndCloseThoseThatAreGone) {
  Stored requests(Type::kOperatorRequests);
  const std::string ready =
      "requests { request_id: 'r' text: 't' requested_at_unix_us: 7000 confirm_delivery_ready {} }";
  const std::string complete = "requests { request_id: 'c' confirm_delivery_complete {} }";
  const auto records = requests.After("operator_action_requests { " + ready + " }");
  ASSERT_EQ(records.size(), 1U);
  EXPECT_EQ(std::get<model::OperatorRequest>(records[0]),
            (model::OperatorRequest{.unix_time_ms = 9,
                                    .request_id = "r",
                                    .kind = model::OperatorRequestKind::kConfirmDeliveryReady,
                                    .text = "t",
                                    .requested_at_ms = 7,
                                    .open = true}));
  EXPECT_THAT(requests.RequestsAfter("operator_action_requests { " + ready + complete + " }"),
              ElementsAre("c open"));
  EXPECT_THAT(requests.RequestsAfter("operator_action_requests { " + complete + " }"),
              ElementsAre("r closed"));
  EXPECT_THAT(requests.RequestsAfter(""), IsEmpty()) << "a set that is missing closes nothing";
  EXPECT_THAT(requests.RequestsAfter("operator_action_requests {}"), ElementsAre("c closed"));
}

TEST(OperatorRequestKind, TextsLeadBack) {
  for (const auto kind : {model::OperatorRequestKind::kConfirmDeliveryReady,
                          model::OperatorRequestKind::kConfirmDeliveryComplete}) {
    EXPECT_EQ(model::OperatorRequestKindFromText(ToText(kind)), kind);
  }
  EXPECT_EQ(model::OperatorRequestKindFromText("confirm"), std::nullopt);
}

}  // namespace
}  // namespace uplink::uncrew
