#include <variant>

#include "schema/json/fields.h"
#include "schema/json/render.h"

namespace uplink::json {
namespace {

using boost::json::array;
using boost::json::object;

/// What one event kind holds; one overload an alternative.
struct DetailRenderer {
  object operator()(const model::EstopEngagedEvent&) const { return {}; }
  object operator()(const model::EstopReleasedEvent&) const { return {}; }
  object operator()(const model::ModeChangedEvent& event) const {
    return Fields().Set("from", event.from).Set("to", event.to).Take();
  }
  object operator()(const model::MissionStartedEvent& event) const {
    return Fields().Set("missionId", event.mission_id).Take();
  }
  object operator()(const model::MissionCompletedEvent& event) const {
    return Fields().Set("missionId", event.mission_id).Take();
  }
  object operator()(const model::FaultRaisedEvent& event) const {
    return Fields().Set("faultCode", event.fault_code).Set("description", event.description).Take();
  }
  object operator()(const model::FaultClearedEvent& event) const {
    return Fields().Set("faultCode", event.fault_code).Take();
  }
};

bool IsVoid(const model::EventKind& kind) {
  return std::holds_alternative<model::EstopEngagedEvent>(kind) ||
         std::holds_alternative<model::EstopReleasedEvent>(kind);
}

object RenderService(const model::ServiceCapability& service) {
  return Fields()
      .Set("name", service.name)
      .Set("description", service.description)
      .Set("capabilityType", service.capability_type)
      .SetIf("confirmationMessage", service.confirmation_message)
      .Set("stateKey", service.state_key)
      .Set("requiresRole", service.requires_role)
      .Set("dangerLevel", service.danger_level)
      .Take();
}

object RenderSensor(const model::SensorCapability& sensor) {
  Fields fields;
  fields.Set("key", sensor.key)
      .Set("label", sensor.label)
      .Set("valueType", sensor.value_type)
      .Set("unit", sensor.unit)
      .Set("displayHint", sensor.display_hint);
  if (sensor.range) fields.Set("rangeMin", sensor.range->min).Set("rangeMax", sensor.range->max);
  return fields.Take();
}

object RenderSetting(const model::SettingDescriptor& setting) {
  Fields fields;
  fields.Set("key", setting.key)
      .Set("label", setting.label)
      .Set("valueType", setting.value_type)
      .Set("default", Render(setting.default_value))
      .SetIf("step", setting.step);
  if (setting.range) {
    fields.Set("range",
               Fields().Set("min", setting.range->min).Set("max", setting.range->max).Take());
  }
  return fields.Take();
}

}  // namespace

boost::json::value Render(const model::Value& value) {
  if (const auto* name = std::get_if<model::EnumName>(&value)) return Json(name->name);
  if (const auto* text = std::get_if<std::string>(&value)) return Json(*text);
  if (const auto* number = std::get_if<std::int32_t>(&value)) return Json(*number);
  if (const auto* number = std::get_if<double>(&value)) return Json(*number);
  return Json(std::get<bool>(value));
}

object RenderDetail(const model::EventKind& kind) { return std::visit(DetailRenderer(), kind); }

object RenderByKey(const model::CurrentSettings& settings) {
  Fields fields;
  for (const model::SettingUpdate& update : settings.settings) {
    fields.Set(update.key, Render(update.value));
  }
  return fields.Take();
}

object Render(const model::MissionRunStatus& body) {
  Fields fields;
  fields.Set("unixTimeMs", body.unix_time_ms)
      .Set("missionId", body.mission_id)
      .Set("runId", body.run_id)
      .Set("status", body.status)
      .SetIf("statusMessage", body.status_message)
      .SetIf("progressX100", body.progress_x100)
      .SetIf("currentPathId", body.current_path_id);
  if (body.current_target) fields.Set("currentTarget", Render(*body.current_target));
  return fields.SetIf("currentStep", body.current_step)
      .SetIf("totalSteps", body.total_steps)
      .SetIf("timeStartedMs", body.time_started_ms)
      .SetIf("expectedEndTimeMs", body.expected_end_time_ms)
      .SetIf("timeCompletedMs", body.time_completed_ms)
      .SetIf("name", body.name)
      .Take();
}

object Render(const model::EventTelemetry& body) {
  Fields kind;
  const std::string_view name = model::EventKindText(body.kind);
  if (IsVoid(body.kind)) {
    kind.Set(name, boost::json::value(nullptr));
  } else {
    kind.Set(name, RenderDetail(body.kind));
  }
  return Fields().Set("unixTimeMs", body.unix_time_ms).Set("kind", kind.Take()).Take();
}

object Render(const model::UiCapabilities& body) {
  return Fields()
      .Set("services", ListOf(body.services, RenderService))
      .Set("sensors", ListOf(body.sensors, RenderSensor))
      .Set("settings", ListOf(body.settings, RenderSetting))
      .Take();
}

object Render(const model::Fault& body) {
  return Fields()
      .Set("unixTimeMs", body.unix_time_ms)
      .Set("faultId", body.fault_id)
      .Set("source", body.source)
      .Set("severity", body.severity)
      .Set("active", body.active)
      .Set("category", body.category)
      .Set("description", body.description)
      .Set("suggestedAction", body.suggested_action)
      .Take();
}

array Render(const model::CurrentSettings& body) {
  return ListOf(body.settings, [](const model::SettingUpdate& update) {
    return Fields().Set("key", update.key).Set("value", Render(update.value)).Take();
  });
}

object Render(const model::Message& body) {
  return Fields()
      .Set("unixTimeMs", body.unix_time_ms)
      .Set("level", body.level)
      .Set("message", body.message)
      .Take();
}

object Render(const model::AgentInfo& body) {
  return Fields()
      .Set("agentVersion", body.agent_version)
      .SetIf("softwareVersion", body.software_version)
      .SetIf("osInfo", body.os_info)
      .SetIf("uptimeS", body.uptime_s)
      .Take();
}

object RenderBody(const model::Body& body) {
  const std::string_view name = model::ToText(model::VariantOf(body));
  return std::visit(
      [name](const auto& member) { return Fields().Set(name, Render(member)).Take(); }, body);
}

}  // namespace uplink::json
