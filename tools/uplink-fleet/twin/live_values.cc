#include "tools/uplink-fleet/twin/live_values.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <utility>

#include <fmt/core.h>

#include "tools/uplink-fleet/twin/canonical.h"

namespace uplink::synthetic {
namespace {

namespace js = boost::json;

/// What the server shows of a message.
enum class Shown : std::uint8_t {
  kNothing,
  kFields,
  /// Its member that is named like the live part.
  kMember,
  /// Parts that the message leaves out are those of no rotation.
  kRotation,
  /// The message has zeros in all parts: no rotation is shown.
  kNoRotation,
  /// Its `data`.
  kData,
  /// All of it.
  kBody,
  kJoints,
  /// The head of a command.
  kCommand,
};

}  // namespace

struct LiveKind {
  std::size_t weight;
  Words words;
  Shown shown = Shown::kNothing;
  /// The live part, or what its joints are grouped by.
  std::string_view path = {};
  std::string_view shown_source = "edge";
  Qos qos = Qos::k0;
};

namespace {

constexpr std::array<std::pair<const char*, const char*>, 3> kChannels = {
    {{"positions", "position"}, {"velocities", "velocity"}, {"efforts", "effort"}}};
/// What joints are called that a message has as fields of its own.
constexpr std::string_view kFlatJoint = "wrist";

constexpr std::string_view kPosition = "twin/{twin}/position";
constexpr std::string_view kPlace =
    R"({"type":"position","position":{"x":"-50..50","y":"-50..50","z":"0..2"}})";
constexpr std::string_view kRotation = "twin/{twin}/rotation";
constexpr std::string_view kHealth = "twin/{twin}/edge_health";
constexpr std::string_view kTelemetry = "twin/{twin}/telemetry";
constexpr std::string_view kJoints = "joint/{twin}/update";
constexpr std::string_view kMaps = R"({"positions":{"_1":"-3..3","_2":"-3..3","_3":"-3..3"},)"
                                   R"("velocities":{"_1":"-3..3","_2":"-3..3","_3":"-3..3"},)"
                                   R"("efforts":{"_1":"-3..3","_2":"-3..3","_3":"-3..3"}})";

constexpr auto kKinds = std::to_array<LiveKind>({
    // An unknown word counts as edge, and is kept.
    {1, FromDriver(kPosition, kPlace, "edge_v2"), Shown::kMember, "position", "edge_v2"},
    {19, FromDriver(kPosition, kPlace), Shown::kMember, "position"},
    // Half of them let the session say that they are simulated.
    {7, FromSimulation(kPosition, kPlace, ""), Shown::kMember, "position", "sim"},
    {7, FromSimulation(kPosition, kPlace), Shown::kMember, "position", "sim"},
    {12, FromDriver(kRotation, R"({"rotation":{"w":"-1..1","z":"-1..1"}})"), Shown::kRotation,
     "rotation"},
    {6, FromSimulation(kRotation, R"({"rotation":{"w":0.0,"x":0.0,"y":0.0,"z":0.0}})"),
     Shown::kNoRotation, "rotation", "sim"},
    {2, FromDriver("twin/{twin}/scale", R"({"scale":{"x":1,"y":1,"z":"1..2"}})"), Shown::kMember,
     "scale"},
    {8,
     FromDriver("twin/{twin}/gps",
                R"({"latitude":"47..48","longitude":"8..9","altitude":"400..500",)"
                R"("compass_heading":"0..359","satellite_count":"7..11#",)"
                R"("fix_type":"rtk_fixed"})",
                ""),
     Shown::kFields, "gps"},
    {16,
     FromDriver(kJoints, R"({"joint_name":"elbow","joint_state":)"
                         R"({"position":"-3..3","velocity":"-3..3","effort":"-3..3"}})"),
     Shown::kJoints, "edge"},
    // By a follower and by its leader, whose joints have the same names.
    {12, FromDriver(kJoints, kMaps, "edge_follower"), Shown::kJoints, "edge_follower"},
    {10, FromDriver(kJoints, kMaps, "edge_leader"), Shown::kJoints, "edge_leader"},
    {8, FromSimulation(kJoints, kMaps), Shown::kJoints, "sim"},
    {16,
     With(Head::kTimeless,
          FromDriver(kJoints, R"({"wrist_1":"-3..3","wrist_2":"-3..3","mode":3})")),
     Shown::kJoints, "edge"},
    {4, FromDriver("twin/{twin}/joint_states", R"({"joint_states":{"gripper":"-3..3"}})", ""),
     Shown::kJoints, "edge"},
    // By the driver, whose edge is the twin itself.
    {4,
     FromDriver(kHealth, R"({"type":"edge_health","twin_uuid":"{twin}","edge_id":"{twin}",)"
                         R"("uptime_seconds":"0..9000","streams":{"front":{"camera_id":"front",)"
                         R"("connection_state":"connected","ice_connection_state":"connected",)"
                         R"("frames_sent":"0..99999#","fps":"20..30","uptime_seconds":"0..900",)"
                         R"("restart_count":0,"is_stale":false,"is_healthy":true}},)"
                         R"("stream_count":1,"healthy_streams":1})"),
     Shown::kFields, "edgeHealth/{twin}"},
    // By the computer that it runs on.
    {2,
     FromDriver(kHealth,
                R"({"twin_uuid":"{twin}","edge_id":"{computer}","uptime_seconds":"0..90000",)"
                R"("streams":{},"stream_count":0,"healthy_streams":0,)"
                R"("host_memory_percent":"0..100","host_cpu_percent":"0..100",)"
                R"("host_disk_percent":"0..100","cpu_temp_c":"30..90"})"),
     Shown::kFields, "edgeHealth/{computer}"},
    {1, FromDriver(kTelemetry, R"({"type":"motor_status","motors":{"left":{"rpm":"0..90"}}})"),
     Shown::kBody, "motors", "edge", Qos::k1},
    {1, FromDriver(kTelemetry, R"({"type":"driver_info","version":"1.1|1.2"})"), Shown::kBody,
     "driverInfo", "edge", Qos::k1},
    {2,
     FromDriver(kTelemetry,
                R"({"telemetry_type":"battery","data":{"level":"0..100","charging":false}})"),
     Shown::kData, "reports/battery", "edge", Qos::k1},
    {1,
     FromDriver("twin/{twin}/event", R"({"event_type":"robot_state","source":"navigation",)"
                                     R"("data":{"mode":"auto","speed":"0..2"}})"),
     Shown::kData, "reports/robot_state", "edge", Qos::k1},
    {5,
     FromDriver("twin/{twin}/battery/status", R"({"percentage":"2..100","voltage":"22..26"})", ""),
     Shown::kFields, "battery"},
    {1,
     FromViewer("twin/{twin}/command",
                R"({"command":"start_video","data":{"token":"candidate:secret"}})"),
     Shown::kCommand, "lastCommand", "tele"},
    // Its position alone: the other channels stay as they were. Null is absent.
    {8,
     FromDriver(kJoints,
                R"({"joint_name":"elbow","joint_state":{"position":"-3..3","velocity":null}})"),
     Shown::kJoints, "edge"},
    // What must change nothing of the above.
    {4, FromDriver(kJoints, R"({"target_positions":{"elbow":"-3..3","wanted_only":"-3..3"}})")},
    {2, FromViewer(kJoints, R"({"joint_name":"elbow","joint_state":{"position":"-3..3"}})")},
    {2, With(Head::kLate, FromDriver(kPosition, kPlace))},
    {2, FromViewer(kPosition, kPlace, "edit")},
    {1, FromViewer("twin/{twin}/webrtc-candidate",
                   R"({"type":"candidate","candidate":"candidate:secret"})", "")},
});

}  // namespace

void LiveValues::ExpectJoints(const LiveKind& kind, const Draft& draft) {
  const Side side = SideOf(kind.words.speaker);
  const auto expect = [&](std::string_view joint, std::string_view channel,
                          const js::value& value) {
    const std::string path = fmt::format("joints/{}/{}/", kind.path, joint);
    speech_.account.Live(side, path + std::string(channel), value);
    if (!draft.body.contains("timestamp")) return;
    speech_.account.Live(side, path + "timestamp", SecondsOf(draft.time_us));
  };
  for (const auto& [name, value] : draft.fields) {
    if (name == "joint_states") {
      for (const auto& joint : value.as_object()) expect(joint.key(), "position", joint.value());
    } else if (name == "joint_state") {
      for (const auto& [channel, said] : value.as_object()) {
        if (!said.is_null()) expect(draft.fields.at("joint_name").as_string(), channel, said);
      }
    } else if (std::string_view(name).starts_with(kFlatJoint)) {
      expect(name, "position", value);
    }
    for (const auto& [map, channel] : kChannels) {
      if (name != map) continue;
      for (const auto& joint : value.as_object()) expect(joint.key(), channel, joint.value());
    }
  }
}

void LiveValues::Expect(const LiveKind& kind, const Draft& draft) {
  js::object shown;
  switch (kind.shown) {
    case Shown::kNothing:
      return;
    case Shown::kJoints:
      return ExpectJoints(kind, draft);
    case Shown::kFields:
      shown = draft.fields;
      for (const char* name : {"type", "twin_uuid", "edge_id"}) shown.erase(name);
      break;
    case Shown::kMember:
      shown = draft.fields.at(kind.path).as_object();
      break;
    case Shown::kRotation:
      shown = {{"w", 1}, {"x", 0}, {"y", 0}, {"z", 0}};
      for (const auto& [name, value] : draft.fields.at(kind.path).as_object()) shown[name] = value;
      break;
    case Shown::kNoRotation:
      shown = {{"w", 1}, {"x", 0}, {"y", 0}, {"z", 0}};
      break;
    case Shown::kData:
      shown = {{"data", draft.fields.at("data")}};
      break;
    case Shown::kBody:
      shown = {{"data", draft.body}};
      break;
    case Shown::kCommand:
      shown = {{"topic", "twin/command"}, {"command", draft.fields.at("command")}};
      break;
  }
  shown["source_type"] = JsonText(kind.shown_source);
  shown["timestamp"] = SecondsOf(draft.time_us);
  const std::string path = speech_.voice.WithIds(kind.path);
  speech_.account.Live(SideOf(kind.words.speaker), path, shown);
}

Publication LiveValues::Say(const LiveKind& kind) {
  const Draft draft = speech_.voice.Begin(kind.words);
  Expect(kind, draft);
  const Speaker speaker = kind.words.speaker;
  if (speaker != Speaker::kViewer) {
    speech_.account.SignOfLife(SideOf(speaker), speech_.voice.now_us());
  }
  return speech_.voice.To(kind.words, draft, kind.qos);
}

Publication LiveValues::Next() { return Say(Choose(speech_.voice.chance(), kKinds)); }

Publication LiveValues::Of(Side side, std::string_view path) {
  return Say(*std::ranges::find_if(kKinds, [&](const LiveKind& kind) {
    return kind.path == path && SideOf(kind.words.speaker) == side;
  }));
}

std::vector<Publication> LiveValues::All() {
  std::vector<Publication> all;
  all.reserve(std::size(kKinds));
  for (const LiveKind& kind : kKinds) all.push_back(Say(kind));
  return all;
}

}  // namespace uplink::synthetic
