#include "schema/decode/decode.h"
#include "schema/decode/fields.h"
#include "schema/limits.h"
#include "schema/rules/numbers.h"
#include "schema/rules/texts.h"

/// Faults, events and messages: durable, so every violation rejects.
namespace uplink::schema {
namespace {

model::EventKind DecodeKind(wire::EventKind::Reader in, Violations& violations) {
  const Path root;
  const Path kind = root.Field("kind");
  const auto member = [&](bool there, const Path& path) {
    if (!there) violations.Content(MissingField(path, "is a null pointer"));
    return there;
  };
  const auto id = [&](const Path& path, std::string_view name, capnp::Text::Reader text) {
    return RequiredText(violations, path.Field(name), View(text), kIdBytesMax);
  };
  switch (in.which()) {
    case wire::EventKind::ESTOP_ENGAGED:
      return model::EstopEngagedEvent{};
    case wire::EventKind::ESTOP_RELEASED:
      return model::EstopReleasedEvent{};
    case wire::EventKind::MODE_CHANGED: {
      if (!member(in.hasModeChanged(), kind.Field("modeChanged"))) return {};
      const auto event = in.getModeChanged();
      return model::ModeChangedEvent{.from = Enum<model::RobotMode>(violations, event.getFrom()),
                                     .to = Enum<model::RobotMode>(violations, event.getTo())};
    }
    case wire::EventKind::MISSION_STARTED: {
      const Path path = kind.Field("missionStarted");
      if (!member(in.hasMissionStarted(), path)) return {};
      return model::MissionStartedEvent{
          id(path, "missionId", in.getMissionStarted().getMissionId())};
    }
    case wire::EventKind::MISSION_COMPLETED: {
      const Path path = kind.Field("missionCompleted");
      if (!member(in.hasMissionCompleted(), path)) return {};
      return model::MissionCompletedEvent{
          id(path, "missionId", in.getMissionCompleted().getMissionId())};
    }
    case wire::EventKind::FAULT_RAISED: {
      const Path path = kind.Field("faultRaised");
      if (!member(in.hasFaultRaised(), path)) return {};
      const auto event = in.getFaultRaised();
      return model::FaultRaisedEvent{
          .fault_code = id(path, "faultCode", event.getFaultCode()),
          .description = DurableText(violations, path.Field("description"),
                                     View(event.getDescription()), kDescriptionBytesMax)};
    }
    case wire::EventKind::FAULT_CLEARED: {
      const Path path = kind.Field("faultCleared");
      if (!member(in.hasFaultCleared(), path)) return {};
      return model::FaultClearedEvent{id(path, "faultCode", in.getFaultCleared().getFaultCode())};
    }
  }
  violations.Content(UnknownVariant(kind, static_cast<unsigned>(in.which())));
  return {};
}

}  // namespace

model::Fault DecodeFault(wire::Fault::Reader in, Violations& violations) {
  const Path root;
  const auto text = [&](std::string_view name, capnp::Text::Reader value, std::size_t bytes_max) {
    return DurableText(violations, root.Field(name), View(value), bytes_max);
  };
  model::Fault out;
  out.unix_time_ms = Time(violations, in.getUnixTimeMs());
  out.fault_id =
      RequiredText(violations, root.Field("faultId"), View(in.getFaultId()), kIdBytesMax);
  out.source = text("source", in.getSource(), kNameBytesMax);
  out.severity = Enum<model::FaultSeverity>(violations, in.getSeverity());
  out.active = in.getActive();
  out.category = text("category", in.getCategory(), kNameBytesMax);
  out.description = text("description", in.getDescription(), kDescriptionBytesMax);
  out.suggested_action = text("suggestedAction", in.getSuggestedAction(), kDescriptionBytesMax);
  return out;
}

model::EventTelemetry DecodeEventTelemetry(wire::EventTelemetry::Reader in,
                                           Violations& violations) {
  const Path root;
  model::EventTelemetry out;
  out.unix_time_ms = Time(violations, in.getUnixTimeMs());
  if (!in.hasKind()) {
    // Read as it stands, a null pointer would say that an e-stop was engaged.
    violations.Content(MissingField(root.Field("kind"), "is a null pointer"));
    return out;
  }
  out.kind = DecodeKind(in.getKind(), violations);
  return out;
}

model::Message DecodeMessage(wire::Message::Reader in, Violations& violations) {
  const Path root;
  model::Message out;
  out.unix_time_ms = Time(violations, in.getUnixTimeMs());
  out.level = Enum<model::MessageLevel>(violations, in.getLevel());
  out.message =
      RequiredText(violations, root.Field("message"), View(in.getMessage()), kMessageTextBytesMax);
  return out;
}

}  // namespace uplink::schema
