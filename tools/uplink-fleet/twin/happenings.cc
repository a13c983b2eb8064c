#include "tools/uplink-fleet/twin/happenings.h"

#include <array>
#include <bit>
#include <utility>

#include <fmt/core.h>

#include "tools/uplink-fleet/twin/canonical.h"

namespace uplink::synthetic {
namespace {

namespace js = boost::json;

struct LevelWord {
  const char* said;
  const char* shown;
};
/// Any case, and words that nobody knows.
constexpr std::array<LevelWord, 7> kLevels = {{{"debug", "info"},
                                               {"INFO", "info"},
                                               {"Warning", "warn"},
                                               {"warn", "warn"},
                                               {"ERROR", "error"},
                                               {"critical", "error"},
                                               {"verbose", "info"}}};
constexpr std::array<const char*, 3> kRunWords = {"queued", "running", "completed"};

Side SideOf(Speaker speaker) { return speaker == Speaker::kSimulation ? Side::kSim : Side::kReal; }

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
std::string Framed(double seconds, std::uint64_t number, const std::string& content) {
  const std::string head = LowFirst(std::bit_cast<std::uint64_t>(seconds), 8) +
                           LowFirst(number, 8) + R"({"content_type":"application/json"})";
  return LowFirst(head.size(), 4) + head + content;
}

}  // namespace

void Happenings::NoteEvent(Side side, const Draft& draft, const std::string& type,
                           std::int64_t sampled_ms) {
  const std::string kind = "cyberwave/" + type;
  speech_.account.Row(draft.number,
                      {.side = side,
                       .kind = RowKind::kEvent,
                       .type = kind,
                       .content = FingerprintOf(EventContent(kind, draft.body, sampled_ms))});
}

Publication Happenings::Event() {
  Draft draft = speech_.voice.Begin(Speaker::kNone, "");
  draft.body["event_type"] = "object_detected";
  draft.body["source"] = "detector";
  draft.body["data"] =
      js::object{{"mark", speech_.voice.MarkOf(draft)}, {"score", speech_.chance.Unit()}};
  NoteEvent(Side::kReal, draft, "object_detected", draft.time_ms());
  speech_.account.SignOfLife(Side::kReal, speech_.voice.now_us());
  return speech_.voice.ToTwin(draft, "event", Qos::k1);
}

Publication Happenings::FramedEvent() {
  Draft draft = speech_.voice.BeginBare();
  draft.body["event_type"] = "zone_entered";
  draft.body["data"] = js::object{{"mark", speech_.voice.MarkOf(draft)}, {"zone", 7}};
  NoteEvent(Side::kReal, draft, "zone_entered", draft.time_ms());
  speech_.account.SignOfLife(Side::kReal, speech_.voice.now_us());
  Publication publication = speech_.voice.ToTwin(draft, "event", Qos::k1);
  publication.payload = Framed(SecondsOf(draft.time_us), draft.number, publication.payload);
  return publication;
}

Publication Happenings::UnknownTelemetry() {
  Draft draft = speech_.voice.Begin(Speaker::kDriver, "edge");
  draft.body["type"] = "gripper_closed";
  draft.body["mark"] = speech_.voice.MarkOf(draft);
  draft.body["force"] = speech_.chance.Between(0, 40);
  NoteEvent(Side::kReal, draft, "gripper_closed", draft.time_ms());
  speech_.account.SignOfLife(Side::kReal, speech_.voice.now_us());
  return speech_.voice.ToTwin(draft, "telemetry", Qos::k1);
}

Publication Happenings::SimulatedTelemetry() {
  Draft draft = speech_.voice.Begin(Speaker::kSimulation, "sim");
  draft.body["type"] = "camera_moved";
  draft.body["mark"] = speech_.voice.MarkOf(draft);
  NoteEvent(Side::kSim, draft, "camera_moved", draft.time_ms());
  speech_.account.SignOfLife(Side::kSim, speech_.voice.now_us());
  return speech_.voice.ToTwin(draft, "telemetry", Qos::k1);
}

js::object Happenings::LogBody(Draft& draft, std::string& message) {
  message = fmt::format("driver says {}", speech_.voice.MarkOf(draft));
  draft.body["container_name"] = "driver";
  draft.body["sdk_version"] = "0.7.4";
  js::object sent = draft.body;
  sent["message"] = message;
  return sent;
}

void Happenings::NoteLog(const Draft& draft, const std::string& message) {
  const std::string said = draft.body.at("level").as_string().c_str();
  std::string shown = "info";
  for (const LevelWord& word : kLevels) {
    if (said == word.said) shown = word.shown;
  }
  speech_.account.Row(
      draft.number,
      {.side = Side::kReal,
       .kind = RowKind::kMessage,
       .type = shown,
       .content = FingerprintOf(MessageContent(shown, message, draft.body, draft.time_ms()))});
  speech_.account.SignOfLife(Side::kReal, speech_.voice.now_us());
}

Publication Happenings::DriverLog() {
  Draft draft = speech_.voice.Begin(Speaker::kDriver, "");
  draft.body["level"] = kLevels.at(speech_.chance.Below(kLevels.size())).said;
  std::string message;
  js::object sent = LogBody(draft, message);
  NoteLog(draft, message);
  draft.body = std::move(sent);
  return speech_.voice.ToTwin(draft, "driverlog", Qos::k1);
}

Publication Happenings::TelemetryLog() {
  Draft draft = speech_.voice.Begin(Speaker::kDriver, "edge");
  draft.body["type"] = "driver_log";
  draft.body["level"] = kLevels.at(speech_.chance.Below(kLevels.size())).said;
  std::string message;
  js::object sent = LogBody(draft, message);
  NoteLog(draft, message);
  draft.body = std::move(sent);
  return speech_.voice.ToTwin(draft, "telemetry", Qos::k1);
}

Publication Happenings::Environment() {
  const std::string& id = speech_.voice.ids().environment;
  Draft draft = speech_.voice.Begin(Speaker::kDriver, "edge");
  draft.body["type"] = "twin_added";
  // What a message without data says instead.
  draft.body[speech_.chance.Chance(0.5) ? "data" : "bindings"] =
      js::object{{"mark", speech_.voice.MarkOf(draft)}};
  speech_.account.Row(draft.number,
                      {.side = Side::kReal,
                       .kind = RowKind::kScope,
                       .type = "environment/twin_added",
                       .content = FingerprintOf(ScopeContent("environment", id, "twin_added",
                                                             draft.body, draft.time_ms()))});
  return speech_.voice.To(fmt::format("environment/{}/twin_added", id), draft, Qos::k1);
}

Publication Happenings::WorkflowRun() {
  const std::string& id = speech_.voice.ids().workflow_run;
  const std::string word = kRunWords.at(speech_.chance.Below(kRunWords.size()));
  Draft draft = speech_.voice.Begin(Speaker::kNone, "");
  draft.body["status"] = word;
  draft.body["mark"] = speech_.voice.MarkOf(draft);
  speech_.account.Row(draft.number, {.side = Side::kReal,
                                     .kind = RowKind::kScope,
                                     .type = "workflow_run/" + word,
                                     .content = FingerprintOf(ScopeContent(
                                         "workflow_run", id, word, draft.body, draft.time_ms()))});
  return speech_.voice.To(fmt::format("workflow-run/{}/status", id), draft, Qos::k1);
}

SentSession& Happenings::SessionOf(Speaker speaker) {
  const TwinIds& ids = speech_.voice.ids();
  const std::string& id = speaker == Speaker::kSimulation ? ids.sim_session
                          : speaker == Speaker::kViewer   ? ids.viewer_session
                                                          : ids.driver_session;
  SentSession& session = speech_.account.Session(id);
  session.side = SideOf(speaker);
  return session;
}

Publication Happenings::Mark(Speaker speaker, std::string_view type, Draft draft) {
  draft.body["type"] = js::string(type.data(), type.size());
  draft.body["mark"] = speech_.voice.MarkOf(draft);
  NoteEvent(SideOf(speaker), draft, std::string(type), draft.time_ms());
  return speech_.voice.ToTwin(draft, "telemetry", Qos::k1);
}

Publication Happenings::Connected(Speaker speaker) {
  SessionOf(speaker).connected = true;
  return Mark(speaker, "connected", speech_.voice.Begin(speaker, ""));
}

Publication Happenings::TelemetryStart(Speaker speaker) {
  SessionOf(speaker).telemetry = true;
  return Mark(speaker, "telemetry_start", speech_.voice.Begin(speaker, ""));
}

Publication Happenings::TelemetryEnd(Speaker speaker) {
  SessionOf(speaker).telemetry = false;
  return Mark(speaker, "telemetry_end", speech_.voice.Begin(speaker, ""));
}

Publication Happenings::Disconnected(Speaker speaker) {
  SentSession& session = SessionOf(speaker);
  session.connected = false;
  session.telemetry = false;
  return Mark(speaker, "disconnected", speech_.voice.Begin(speaker, ""));
}

Publication Happenings::IdleMark(Speaker speaker) {
  Draft draft = speech_.voice.Begin(speaker, "");
  switch (speech_.chance.Below(4)) {
    case 0:
      draft.body["sensor"] = "front";
      return Mark(speaker, "telemetry_end", std::move(draft));
    case 1:
      draft.body["recording_boundary"] = true;
      return Mark(speaker, "telemetry_end", std::move(draft));
    case 2:
      draft.body["recording_boundary"] = true;
      return Mark(speaker, "telemetry_start", std::move(draft));
    default:
      draft.body["observations"] = js::object{{"_1", 0.1}};
      return Mark(speaker, "initial_observation", std::move(draft));
  }
}

}  // namespace uplink::synthetic
