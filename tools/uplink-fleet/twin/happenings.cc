#include "tools/uplink-fleet/twin/happenings.h"

#include <array>
#include <bit>
#include <cstdint>
#include <utility>

#include <fmt/core.h>

#include "tools/uplink-fleet/robot/rows.h"

namespace uplink::synthetic {

struct Happening {
  std::size_t weight;
  Words words;
  RowKind kind = RowKind::kEvent;
  /// What it is called in the store; empty: as its field `status` says.
  std::string_view type;
  /// It shows that the robot is alive.
  bool life = false;
};

namespace {

namespace js = boost::json;

constexpr std::string_view kEvent = "twin/{twin}/event";
constexpr std::string_view kTelemetry = "twin/{twin}/telemetry";
constexpr std::string_view kEnvironment = "environment/{environment}/twin_added";

/// Levels in any case, and unknown words.
constexpr std::string_view kLog =
    R"({"level":"debug|INFO|Warning|warn|ERROR|critical|verbose",)"
    R"("container_name":"driver","sdk_version":"0.7.4","message":"driver says {mark}"})";
constexpr std::string_view kTelemetryLog =
    R"({"type":"driver_log","level":"debug|INFO|Warning|warn|ERROR|critical|verbose",)"
    R"("container_name":"driver","sdk_version":"0.7.4","message":"driver says {mark}"})";
constexpr std::array<std::pair<std::string_view, std::string_view>, 4> kLevels = {
    {{"Warning", "warn"}, {"warn", "warn"}, {"ERROR", "error"}, {"critical", "error"}}};

constexpr Words FromWorker(std::string_view topic, std::string_view body) {
  return {.speaker = Speaker::kNone, .source = "", .topic = topic, .body = body};
}

constexpr auto kHappenings = std::to_array<Happening>({
    // An event as its worker made it.
    {24,
     FromWorker(kEvent, R"({"event_type":"object_detected","source":"detector",)"
                        R"("data":{"mark":"{mark}","score":"0..1"}})"),
     RowKind::kEvent, "object_detected", true},
    // The same in the bridge's frame, which says the time.
    {12,
     With(Head::kNone,
          FromDriver(kEvent, R"({"event_type":"zone_entered","data":{"mark":"{mark}","zone":7}})")),
     RowKind::kEvent, "zone_entered", true},
    // Telemetry of unknown types.
    {24, FromDriver(kTelemetry, R"({"type":"gripper_closed","mark":"{mark}","force":"0..40"})"),
     RowKind::kEvent, "gripper_closed", true},
    {12, FromSimulation(kTelemetry, R"({"type":"camera_moved","mark":"{mark}"})"), RowKind::kEvent,
     "camera_moved", true},
    {18, FromDriver("twin/{twin}/driverlog", kLog, ""), RowKind::kMessage, "log", true},
    {12, FromDriver(kTelemetry, kTelemetryLog), RowKind::kMessage, "log", true},
    {3, FromDriver(kEnvironment, R"({"type":"twin_added","data":{"mark":"{mark}"}})"),
     RowKind::kScope, "twin_added"},
    // What a message without data says instead.
    {3, FromDriver(kEnvironment, R"({"type":"twin_added","bindings":{"mark":"{mark}"}})"),
     RowKind::kScope, "twin_added"},
    {6,
     FromWorker("workflow-run/{run}/status",
                R"({"status":"queued|running|completed","mark":"{mark}"})"),
     RowKind::kScope, ""},
    // Marks that change nothing: a stream's end, a recording's cut, an observation.
    {1, FromDriver(kTelemetry, R"({"type":"telemetry_end","mark":"{mark}","sensor":"front"})", ""),
     RowKind::kEvent, "telemetry_end"},
    {1,
     FromSimulation(kTelemetry,
                    R"({"type":"telemetry_end","mark":"{mark}","recording_boundary":true})", ""),
     RowKind::kEvent, "telemetry_end"},
    {2,
     FromDriver(kTelemetry,
                R"({"type":"telemetry_start","mark":"{mark}","recording_boundary":true})", ""),
     RowKind::kEvent, "telemetry_start"},
    {2,
     FromSimulation(kTelemetry,
                    R"({"type":"initial_observation","mark":"{mark}","observations":{"_1":0.1}})",
                    ""),
     RowKind::kEvent, "initial_observation"},
});

/// `bytes` bytes of it, low byte first.
std::string LowFirst(std::uint64_t number, std::size_t bytes) {
  std::string text;
  for (std::size_t i = 0; i < bytes; ++i) {
    text += static_cast<char>(static_cast<unsigned char>(number >> (8U * i)));
  }
  return text;
}

/// What the bridge puts around an event: the length of the head; the head, which is a time, a
/// number and JSON; the event.
std::string Framed(const Draft& draft, const std::string& content) {
  const std::string head = LowFirst(std::bit_cast<std::uint64_t>(SecondsOf(draft.time_us)), 8) +
                           LowFirst(draft.number, 8) + R"({"content_type":"application/json"})";
  return LowFirst(head.size(), 4) + head + content;
}

std::string TextIn(const js::object& body, const char* name) {
  return body.at(name).as_string().c_str();
}

}  // namespace

void Happenings::Expect(const Happening& what, const Draft& draft) {
  const TwinIds& ids = speech_.voice.ids();
  SentRow row{.side = SideOf(what.words.speaker), .kind = what.kind};
  std::string content;
  switch (what.kind) {
    case RowKind::kEvent:
      row.type = fmt::format("cyberwave/{}", what.type);
      content = EventContent(row.type, draft.body, draft.time_ms());
      break;
    case RowKind::kMessage: {
      row.type = "info";
      for (const auto& [said, shown] : kLevels) {
        if (TextIn(draft.body, "level") == said) row.type = shown;
      }
      js::object detail = draft.body;
      detail.erase("message");
      content = MessageContent(row.type, TextIn(draft.body, "message"), detail, draft.time_ms());
      break;
    }
    case RowKind::kScope: {
      const bool environment = what.words.topic == kEnvironment;
      row.type = what.type.empty() ? TextIn(draft.body, "status") : std::string(what.type);
      content = ScopeContent(environment ? "environment" : "workflow_run",
                             environment ? ids.environment : ids.workflow_run, row.type, draft.body,
                             draft.time_ms());
      break;
    }
  }
  row.content = HashOf(content);
  speech_.account.Row(draft.number, std::move(row));
}

Publication Happenings::Say(const Happening& what) {
  const Draft draft = speech_.voice.Begin(what.words);
  Expect(what, draft);
  if (what.life) {
    speech_.account.SignOfLife(SideOf(what.words.speaker), speech_.voice.now_us());
  }
  Publication publication = speech_.voice.To(what.words, draft, Qos::k1);
  if (what.words.head == Head::kNone) publication.payload = Framed(draft, publication.payload);
  return publication;
}

Publication Happenings::Next() { return Say(Choose(speech_.voice.chance(), kHappenings)); }

Publication Happenings::Mark(Speaker speaker, std::string_view type) {
  const TwinIds& ids = speech_.voice.ids();
  SentSession& session =
      speech_.account.Session(speaker == Speaker::kSimulation ? ids.sim_session
                              : speaker == Speaker::kViewer   ? ids.viewer_session
                                                              : ids.driver_session);
  session.side = SideOf(speaker);
  if (type == "connected" || type == "disconnected") session.connected = type == "connected";
  if (type != "connected") session.telemetry = type == "telemetry_start";
  const std::string body = fmt::format(R"({{"type":"{}","mark":"{{mark}}"}})", type);
  return Say({.weight = 1,
              .words = {.speaker = speaker, .source = "", .topic = kTelemetry, .body = body},
              .kind = RowKind::kEvent,
              .type = type});
}

}  // namespace uplink::synthetic
