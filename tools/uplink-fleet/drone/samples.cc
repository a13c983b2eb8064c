#include "tools/uplink-fleet/drone/samples.h"

#include <array>
#include <string_view>
#include <utility>

#include <boost/json.hpp>
#include <fmt/core.h>
#include <google/protobuf/descriptor.h>

#include "schema/base/rfc3339.h"
#include "schema/json/exact.h"
#include "tools/uplink-fleet/drone/shown.h"
#include "tools/uplink-fleet/twin/account.h"
#include "tools/uplink-fleet/twin/canonical.h"

namespace uplink::synthetic {
namespace {

namespace js = boost::json;

/// What the server makes of a sample: only live state; an event if it says something
/// new; an event; a message for people.
enum class Becomes : std::uint8_t { kLive, kChange, kEvent, kText };

}  // namespace

struct SampleKind {
  std::string_view type;
  Becomes becomes;
  /// Seconds from one sample to the next; of what is stored on average.
  std::size_t every_s;
  std::string_view json;
  /// The field by which samples of a type are told apart, and how many a drone has.
  std::string_view key = {};
  std::uint32_t keys = 1;
  /// In place of the field's name in `Robot.uncrew`.
  std::string_view shown = {};
  /// Of its event.
  std::string_view event = {};
};

namespace {

/// In how many of the seconds what was stored is sent once more.
constexpr double kAgainShare = 0.02;

constexpr auto kKinds = std::to_array<SampleKind>({
    {"Position", Becomes::kLive, 1,
     R"({"position":{"latitude_deg":"47..48","longitude_deg":"8..9","absolute_altitude_m":"400..500",)"
     R"("relative_altitude_m":"0..90"}})"},
    {"Altitude", Becomes::kLive, 1,
     R"({"altitude":{"altitude_monotonic_m":"0..90","altitude_amsl_m":"400..500",)"
     R"("altitude_local_m":"-9..90","altitude_relative_m":"0..90","bottom_clearance_m":"0..90"}})"},
    {"VelocityNed", Becomes::kLive, 1,
     R"({"velocity_ned":{"north_m_s":"-20..20","east_m_s":"-20..20","down_m_s":"-3..3"}})"},
    {"Heading", Becomes::kLive, 1, R"({"heading":{"heading_deg":"0..359"}})"},
    {"PoseEuler", Becomes::kLive, 1,
     R"({"pose_euler":{"roll_deg":"-45..45#","pitch_deg":"-30..30#","yaw_deg":"-179..180#"}})"},
    {"Odometry", Becomes::kLive, 2,
     R"({"odometry":{"frame_id":"FRAME_BODY_NED|FRAME_ESTIM_NED","child_frame_id":"FRAME_BODY_NED",)"
     R"("position_m":{"x":"-9..9","y":"-9..9","z":"-90..0"},"q":{"w":1,"x":"0..1"},)"
     R"("velocity_m_s":{"x":"-9..9"},"angular_velocity_rad_s":{"yaw":"-1..1"},"pose_covariance":)"
     R"({"covariance_matrix":["0..1",1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20]}}})"},
    {"Imu", Becomes::kLive, 1,
     R"({"imu":{"acceleration_m_s2":{"forward":"-5..5","right":"-5..5","down":"8..11"},)"
     R"("angular_velocity_rad_s":{"forward":"-1..1"},"temperature_degc":"20..40"}})"},
    {"Battery", Becomes::kLive, 3,
     R"({"battery":{"id":"{key}","voltage_v":"21..26","current_battery_a":"-2..40",)"
     R"("remaining_percent":"0..100","temperature_degc":"20..50",)"
     R"("battery_function":"BATTERY_FUNCTION_ALL|BATTERY_FUNCTION_PAYLOAD"}})",
     "id", 2},
    {"GPSInfo", Becomes::kLive, 4,
     R"({"gps_info":{"num_satellites":"7..30#","fix_type":)"
     R"("GPS_FIX_TYPE_FIX_3D|GPS_FIX_TYPE_RTK_FIXED|GPS_FIX_TYPE_NO_FIX"}})"},
    {"Health", Becomes::kLive, 5,
     R"({"health":{"is_gyrometer_calibration_ok":true,"is_home_position_ok":false,)"
     R"("is_armable":true}})"},
    {"DistanceSensor", Becomes::kLive, 1,
     R"({"distance_sensor":{"id":"{key}","minimum_distance_m":0.25,"current_distance_m":"0..40",)"
     R"("orientation":{"pitch_deg":-90}}})",
     "id", 2},
    {"GimbalControlStatus", Becomes::kLive, 6,
     R"({"gimbal_control_status":{"gimbal_id":"{key}","control_mode":"CONTROL_MODE_PRIMARY",)"
     R"("sysid_primary_control":"1..255#"}})",
     "gimbal_id"},
    {"CameraMode", Becomes::kLive, 5,
     R"({"camera_mode":{"camera_id":"{key}","mode":"CAMERA_MODE_PHOTO|CAMERA_MODE_VIDEO"}})",
     "camera_id"},
    {"VideoStreamSettings", Becomes::kLive, 10,
     R"({"video_stream_settings":{"stream_id":"{key}","frame_rate_hz":"10..60",)"
     R"("horizontal_resolution_pix":1920,"bit_rate_b_s":"1000..9000#","uri":"rtsp://uav/front"}})",
     "stream_id"},
    {"WinchStatus", Becomes::kLive, 2,
     R"({"winch_status":{"instance":"{key}","line_length_m":"0..30","tension_kg":"0..4",)"
     R"("temperature_c":"-5..60#","status_flags":{"healthy":true,"moving":true}}})",
     "instance"},
    {"WinchReelStatus", Becomes::kLive, 7,
     R"({"winch_reel_status":{"instance":"{key}","state":"spooled|empty","line_remaining_m":"0..30"}})",
     "instance"},
    {"Armed", Becomes::kChange, 9, R"({"armed":{"is_armed":"true|false"}})", {}, 1, {}, "armed"},
    {"FlightMode",
     Becomes::kChange,
     6,
     R"({"flight_mode":{"mode":"FLIGHT_MODE_HOLD|FLIGHT_MODE_MISSION|FLIGHT_MODE_RETURN_TO_LAUNCH"}})",
     {},
     1,
     {},
     "flightMode"},
    {"UncrewFlightMode",
     Becomes::kChange,
     2,
     R"({"uncrew_flight_mode":{"mode":"cruise|deliver","detail":"leg {number}"}})",
     {},
     1,
     {},
     "uncrewFlightMode"},
    {"CurrentMissionItem",
     Becomes::kChange,
     5,
     R"({"current_mission_item":{"current":"0..7#","total":7,"mission_id":"round"}})",
     {},
     1,
     {},
     "missionItem"},
    {"StatusText", Becomes::kText, 4,
     R"({"status_text":{"type":"STATUS_TEXT_TYPE_NOTICE|STATUS_TEXT_TYPE_WARNING|)"
     R"(STATUS_TEXT_TYPE_ERROR|STATUS_TEXT_TYPE_EMERGENCY","text":"status {number}"}})"},
    {"ConnectionEvent",
     Becomes::kEvent,
     10,
     R"({"connection_event":{"kind":"KIND_CONNECTED|KIND_DISCONNECTED",)"
     R"("link":"autopilot|winch|avatar","text":"link {number}"}})",
     {},
     1,
     {},
     "connection"},
    {"Error",
     Becomes::kEvent,
     15,
     R"({"error":{"code":"E7|E12","text":"error {number}","source":"autopilot"}})",
     {},
     1,
     {},
     "error"},
    {"UAVCommandResult",
     Becomes::kEvent,
     12,
     R"({"command_id":"{number}","status":{"state":"STATE_STARTED|STATE_SUCCEEDED|STATE_FAILED",)"
     R"("text":"by plan"}})",
     {},
     1,
     "commandResult",
     "commandResult"},
});

/// The sample of a request: its one member that is neither metadata nor an id.
const google::protobuf::FieldDescriptor& MemberOf(const google::protobuf::Message& request) {
  const auto* type = request.GetDescriptor();
  const auto* last = type->field(type->field_count() - 1);
  return *last;
}

std::string_view LevelOf(std::string_view source_level) {
  if (source_level == "warning") return "warn";
  const bool info = source_level == "debug" || source_level == "info" || source_level == "notice";
  return info ? "info" : "error";
}

std::string_view TextIn(const js::object& object, const char* name) {
  const js::string& text = object.at(name).as_string();
  return {text.data(), text.size()};
}

}  // namespace

DroneSamples::DroneSamples(const DroneSpeech& speech) : speech_(speech) {
  for (const SampleKind& kind : kKinds) {
    for (std::uint32_t key = 0; key < kind.keys; ++key) {
      lines_.push_back(
          {.kind = &kind, .key = key, .chance = speech_.voice.ChanceOf(lines_.size())});
    }
  }
}

std::vector<AvatarCall> DroneSamples::Second(const std::function<bool(std::size_t)>& busy,
                                             bool only_live) {
  std::vector<AvatarCall> calls;
  for (std::size_t at = 0; at < lines_.size(); ++at) {
    Line& line = lines_[at];
    const bool anew =
        line.last.number == 0 || line.chance.Chance(1 / static_cast<double>(line.kind->every_s));
    if (line.kind->becomes == Becomes::kLive) {
      calls.push_back(anew ? Take(at) : line.last);
      if (!anew) calls.back().due.outcomes = kSaysTheSame;
      continue;
    }
    const bool again = line.kind->becomes == Becomes::kChange || line.chance.Chance(kAgainShare);
    if (only_live || busy(at)) continue;
    if (anew) {
      calls.push_back(Take(at));
    } else if (again) {
      calls.push_back(line.last);
      // A mode that changed nothing was not stored.
      calls.back().due.outcomes = line.kind->becomes == Becomes::kChange
                                      ? kIsGood
                                      : Outcomes(::uncrew::v1::OUTCOME_DUPLICATE);
    }
  }
  return calls;
}

std::vector<AvatarCall> DroneSamples::All() {
  std::vector<AvatarCall> calls;
  for (std::size_t at = 0; at < lines_.size(); ++at) calls.push_back(Take(at));
  return calls;
}

AvatarCall DroneSamples::Again() const {
  AvatarCall again = lines_.front().last;
  again.number = 0;
  return again;
}

AvatarCall DroneSamples::Take(std::size_t at) {
  Line& line = lines_[at];
  AvatarDraft draft =
      speech_.voice.Begin(line.kind->type, at, line.kind->json, line.chance, line.key);
  Expect(line, draft);
  line.last = DroneVoice::Finish(std::move(draft));
  return line.last;
}

void DroneSamples::Expect(Line& line, AvatarDraft& draft) {
  const SampleKind& kind = *line.kind;
  const google::protobuf::Message& request = *draft.request;
  const auto& member = MemberOf(request);
  js::object shown = ShownOf(request.GetReflection()->GetMessage(request, &member), kind.key);
  if (const auto* id = request.GetDescriptor()->FindFieldByName("command_id")) {
    shown["commandId"] = request.GetReflection()->GetString(request, id);
  }
  std::string path(kind.shown.empty() ? std::string_view(member.json_name()) : kind.shown);
  if (!kind.key.empty()) path += fmt::format("/{}", line.key);
  js::object stamped = shown;
  stamped["sampledAt"] = Rfc3339OfUs(draft.time_us);
  speech_.account.Live(path, stamped);
  const std::string key = fmt::format("{} {}", kind.event, draft.time_ms());
  draft.call.due.outcomes = kStores;
  switch (kind.becomes) {
    case Becomes::kLive:
      draft.call.live = true;
      draft.call.due.outcomes = kApplies;
      return;
    case Becomes::kText: {
      const std::string_view level = TextIn(shown, "type");
      speech_.account.Row(draft.call.number,
                          {.list = DroneList::kMessages,
                           .key = key,
                           .content = MessageContent(LevelOf(level), TextIn(shown, "text"),
                                                     js::object{{"sourceLevel", JsonText(level)}},
                                                     draft.time_ms())});
      return;
    }
    case Becomes::kEvent:
      speech_.account.Row(draft.call.number,
                          {.list = DroneList::kEvents,
                           .key = key,
                           .content = EventContent(kind.event, shown, draft.time_ms())});
      return;
    case Becomes::kChange:
      break;
  }
  // One of one field, and Uncrew's, is its mode; a mission item is all that it says.
  const bool whole = kind.event == "missionItem";
  ExpectChange(line, draft, whole ? js::value(shown) : shown.begin()->value());
}

void DroneSamples::ExpectChange(Line& line, AvatarDraft& draft, const js::value& now) {
  const std::string said = CanonicalText(now);
  const std::string before = std::exchange(line.said, said);
  if (before == said) {
    draft.call.due.outcomes = kSaysTheSame;
    return;
  }
  DroneRow row{.list = DroneList::kEvents,
               .key = fmt::format("{} {}", line.kind->event, draft.time_ms()),
               .content = {},
               .sure = !before.empty()};
  if (before.empty()) {
    // What an earlier run said last is not known.
    draft.call.due.outcomes = kIsGood;
  } else {
    row.content =
        EventContent(line.kind->event, js::object{{"from", *json::ParseExact(before)}, {"to", now}},
                     draft.time_ms());
  }
  speech_.account.Row(draft.call.number, std::move(row));
}

}  // namespace uplink::synthetic
