#include <variant>

#include "schema/encode/encode_body.h"

namespace uplink::schema {
namespace {

/// Writes one event kind; one overload an alternative.
struct KindEncoder {
  wire::EventKind::Builder out;

  void operator()(const model::EstopEngagedEvent&) { out.setEstopEngaged(); }
  void operator()(const model::EstopReleasedEvent&) { out.setEstopReleased(); }
  void operator()(const model::ModeChangedEvent& in) {
    auto event = out.initModeChanged();
    event.setFrom(Enum<wire::RobotMode>(in.from));
    event.setTo(Enum<wire::RobotMode>(in.to));
  }
  void operator()(const model::MissionStartedEvent& in) {
    out.initMissionStarted().setMissionId(Text(in.mission_id));
  }
  void operator()(const model::MissionCompletedEvent& in) {
    out.initMissionCompleted().setMissionId(Text(in.mission_id));
  }
  void operator()(const model::FaultRaisedEvent& in) {
    auto event = out.initFaultRaised();
    event.setFaultCode(Text(in.fault_code));
    event.setDescription(Text(in.description));
  }
  void operator()(const model::FaultClearedEvent& in) {
    out.initFaultCleared().setFaultCode(Text(in.fault_code));
  }
  void operator()(const model::NamedEvent&) {}
};

}  // namespace

void EncodeMember(const model::EventTelemetry& in, wire::UplinkMsg::Builder message) {
  auto out = message.initEventTelemetry();
  out.setUnixTimeMs(in.unix_time_ms);
  // The wire has no member for a named event. One of no kind is judged to be nothing, while an
  // empty kind would say that an e-stop was engaged.
  if (std::holds_alternative<model::NamedEvent>(in.kind)) return;
  std::visit(KindEncoder{out.initKind()}, in.kind);
}

void EncodeMember(const model::Fault& in, wire::UplinkMsg::Builder message) {
  auto out = message.initFault();
  out.setUnixTimeMs(in.unix_time_ms);
  out.setFaultId(Text(in.fault_id));
  out.setSource(Text(in.source));
  out.setSeverity(Enum<wire::FaultSeverity>(in.severity));
  out.setActive(in.active);
  out.setCategory(Text(in.category));
  out.setDescription(Text(in.description));
  out.setSuggestedAction(Text(in.suggested_action));
}

void EncodeMember(const model::Message& in, wire::UplinkMsg::Builder message) {
  auto out = message.initMessage();
  out.setUnixTimeMs(in.unix_time_ms);
  out.setLevel(Enum<wire::MessageLevel>(in.level));
  out.setMessage(Text(in.message));
}

}  // namespace uplink::schema
