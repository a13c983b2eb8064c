#include "tools/uplink-fleet/drone/wrongs.h"

#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "tools/uplink-fleet/twin/filling.h"

namespace uplink::synthetic {
namespace {

using model::RejectReason;

struct Wrong {
  RejectReason reason;
  std::string_view type;
  /// `~` stands for a text that is too long, `#` for so many alerts.
  std::string_view json;
  std::string_view field;
  /// Bytes that are missing at its end.
  std::size_t cut = 0;
};

constexpr std::size_t kTextBytesMax = 4096;
constexpr std::size_t kIdBytesMax = 128;
constexpr std::size_t kAlertsMax = 64;

constexpr auto kWrongs = std::to_array<Wrong>({
    {RejectReason::kMalformed, "Battery", R"({"battery":{"voltage_v":22}})", "", 1},
    {RejectReason::kMalformed, "Alert", R"({"alerts":{"alerts":[{"alert_id":"a"}]}})", "", 1},
    {RejectReason::kMissingField, "Position", "{}", "position"},
    {RejectReason::kMissingField, "Alert", "{}", "alerts"},
    {RejectReason::kMissingField, "OperatorActionRequests", "{}", "operator_action_requests"},
    {RejectReason::kMissingField, "OperatorActionRequests",
     R"({"operator_action_requests":{"requests":[{"confirm_delivery_ready":{}}]}})",
     "operator_action_requests[0].request_id"},
    {RejectReason::kMissingField, "StatusText", R"({"status_text":{}})", "status_text.text"},
    {RejectReason::kMissingField, "UAVCommandResult", R"({"status":{"state":"STATE_FAILED"}})",
     "command_id"},
    {RejectReason::kTextTooLong, "StatusText", R"({"status_text":{"text":"~"}})",
     "status_text.text"},
    {RejectReason::kTextTooLong, "CurrentMissionItem",
     R"({"current_mission_item":{"total":3,"mission_id":"~"}})", "current_mission_item.mission_id"},
    {RejectReason::kOutOfRange, "Battery", R"({"battery":{"remaining_percent":106}})",
     "battery.remaining_percent"},
    {RejectReason::kOutOfRange, "CurrentMissionItem",
     R"({"current_mission_item":{"current":4,"total":3}})", "current_mission_item.current"},
    {RejectReason::kOutOfRange, "VelocityNed", R"({"velocity_ned":{"down_m_s":1001}})",
     "velocity_ned.down_m_s"},
    {RejectReason::kNotFinite, "Heading", R"({"heading":{"heading_deg":"Infinity"}})",
     "heading.heading_deg"},
    {RejectReason::kTooFewItems, "Odometry",
     R"({"odometry":{"pose_covariance":{"covariance_matrix":[1,2,3]}}})",
     "odometry.pose_covariance.covariance_matrix"},
    {RejectReason::kTooManyItems, "Alert", R"({"alerts":{"alerts":[#]}})", "alerts"},
    {RejectReason::kUnknownVariant, "Alert", R"({"alerts":{"alerts":[{"alert_id":"a"}]}})",
     "alerts[0]"},
    {RejectReason::kDuplicateKey, "Alert",
     R"({"alerts":{"alerts":[{"alert_id":"a","battery":{}},{"alert_id":"a","battery":{}}]}})",
     "alerts[1].alert_id"},
});

std::string JsonOf(const Wrong& wrong) {
  const std::size_t longest = wrong.field.ends_with("_id") ? kIdBytesMax : kTextBytesMax;
  std::string alerts = "{}";
  for (std::size_t i = 0; i < kAlertsMax; ++i) alerts += ",{}";
  return Replaced(Replaced(std::string(wrong.json), "~", std::string(longest + 1, 'x')), "#",
                  alerts);
}

}  // namespace

std::size_t DroneWrongKinds() { return kWrongs.size(); }

AvatarCall DroneWrongs::Next() {
  const Wrong& wrong = kWrongs.at(next_);
  next_ = (next_ + 1) % kWrongs.size();
  AvatarCall call =
      DroneVoice::Finish(speech_.voice.Begin(wrong.type, line_, JsonOf(wrong), chance_));
  call.request.resize(call.request.size() - wrong.cut);
  call.due = {.outcomes = kIsWrong, .reason = wrong.reason, .field = std::string(wrong.field)};
  speech_.account.Row(call.number,
                      {.list = DroneList::kQuarantine,
                       // Rows that say the same are counted.
                       .key = QuarantineContent(model::ToText(wrong.reason), wrong.field,
                                                static_cast<std::int64_t>(call.request.size()),
                                                "uncrew", call.method),
                       .content = {}});
  return call;
}

}  // namespace uplink::synthetic
