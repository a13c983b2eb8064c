#include "schema/json/fields.h"
#include "schema/json/render.h"

namespace uplink::json {
namespace {

using boost::json::array;
using boost::json::object;

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

object Render(const model::UiCapabilities& body) {
  return Fields()
      .Set("services", ListOf(body.services, RenderService))
      .Set("sensors", ListOf(body.sensors, RenderSensor))
      .Set("settings", ListOf(body.settings, RenderSetting))
      .Take();
}

array Render(const model::CurrentSettings& body) {
  return ListOf(body.settings, [](const model::SettingUpdate& update) {
    return Fields().Set("key", update.key).Set("value", Render(update.value)).Take();
  });
}

object RenderByKey(const model::CurrentSettings& settings) {
  Fields fields;
  for (const model::SettingUpdate& update : settings.settings) {
    fields.Set(update.key, Render(update.value));
  }
  return fields.Take();
}

}  // namespace uplink::json
