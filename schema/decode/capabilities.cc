#include <string_view>
#include <unordered_set>
#include <utility>

#include "schema/decode/decode.h"
#include "schema/decode/fields.h"
#include "schema/limits.h"
#include "schema/rules/numbers.h"
#include "schema/rules/texts.h"

/// Capabilities and settings: durable, so every fault rejects. Reading stops at the first one.
namespace uplink::schema {
namespace {

/// Names of one list, each of which may stand once. Views into the message.
class UniqueKeys {
 public:
  std::string Required(Faults& faults, const Path& path, std::string_view key,
                       std::size_t bytes_max) {
    std::string kept = RequiredText(faults, path, key, bytes_max);
    if (!faults.rejected() && !seen_.insert(key).second) faults.Content(DuplicateKey(path, key));
    return kept;
  }

 private:
  std::unordered_set<std::string_view> seen_;
};

model::Value RequiredValue(Faults& faults, const Path& path, bool there, wire::Value::Reader in) {
  if (!there) {
    faults.Content(MissingField(path, "is a null pointer"));
    return {};
  }
  return JudgeValue(faults, path, in).value_or(model::Value());
}

/// Robots write a whole number as int, and the default of an enum as a string.
bool Matches(model::ValueType declared, model::ValueType type) {
  using model::ValueType;
  if (declared == type || !model::IsRecognized(declared)) return true;
  return (declared == ValueType::kNumber && type == ValueType::kInt) ||
         (declared == ValueType::kEnum && type == ValueType::kString);
}

std::optional<model::Range> JudgeRange(Faults& faults, const Path& min_path, const Path& max_path,
                                       const model::Range& raw) {
  const auto min = Finite(faults, min_path, raw.min);
  const auto max = Finite(faults, max_path, raw.max);
  if (!min || !max) return std::nullopt;
  if (*min > *max) faults.Content(MinAboveMax(min_path, *min, *max));
  return raw;
}

model::ServiceCapability DecodeService(wire::ServiceCapability::Reader in, const Path& path,
                                       Faults& faults, UniqueKeys& names) {
  model::ServiceCapability out;
  out.name = names.Required(faults, path.Field("name"), View(in.getName()), kNameBytesMax);
  out.description = DurableText(faults, path.Field("description"), View(in.getDescription()),
                                kDescriptionBytesMax);
  out.capability_type = Enum<model::CapabilityType>(faults, in.getCapabilityType());
  if (in.getHasConfirmationMessage()) {
    out.confirmation_message = DurableText(faults, path.Field("confirmationMessage"),
                                           View(in.getConfirmationMessage()), kDescriptionBytesMax);
  }
  out.state_key = DurableText(faults, path.Field("stateKey"), View(in.getStateKey()), kIdBytesMax);
  out.requires_role = Enum<model::Role>(faults, in.getRequiresRole());
  out.danger_level = Enum<model::DangerLevel>(faults, in.getDangerLevel());
  return out;
}

model::SensorCapability DecodeSensor(wire::SensorCapability::Reader in, const Path& path,
                                     Faults& faults, UniqueKeys& keys) {
  model::SensorCapability out;
  out.key = keys.Required(faults, path.Field("key"), View(in.getKey()), kIdBytesMax);
  out.label = DurableText(faults, path.Field("label"), View(in.getLabel()), kNameBytesMax);
  out.value_type = Enum<model::ValueType>(faults, in.getValueType());
  out.unit = DurableText(faults, path.Field("unit"), View(in.getUnit()), kNameBytesMax);
  if (in.getHasRange()) {
    out.range = JudgeRange(faults, path.Field("rangeMin"), path.Field("rangeMax"),
                           {.min = in.getRangeMin(), .max = in.getRangeMax()});
  }
  out.display_hint = Enum<model::DisplayHint>(faults, in.getDisplayHint());
  return out;
}

model::SettingDescriptor DecodeSetting(wire::SettingDescriptor::Reader in, const Path& path,
                                       Faults& faults, UniqueKeys& keys) {
  model::SettingDescriptor out;
  out.key = keys.Required(faults, path.Field("key"), View(in.getKey()), kIdBytesMax);
  out.label = DurableText(faults, path.Field("label"), View(in.getLabel()), kNameBytesMax);
  out.value_type = Enum<model::ValueType>(faults, in.getValueType());
  const Path default_path = path.Field("default");
  out.default_value = RequiredValue(faults, default_path, in.hasDefault(), in.getDefault());
  const model::ValueType type = model::TypeOf(out.default_value);
  if (!Matches(out.value_type, type)) {
    faults.Content(
        TypeMismatch(default_path, model::EnumText(type), model::EnumText(out.value_type)));
  }
  if (in.getHasRange() && in.hasRange()) {
    const Path range = path.Field("range");
    out.range = JudgeRange(faults, range.Field("min"), range.Field("max"),
                           {.min = in.getRange().getMin(), .max = in.getRange().getMax()});
  }
  if (in.getHasStep()) out.step = Finite(faults, path.Field("step"), in.getStep());
  return out;
}

bool CountIsGood(Faults& faults, const Path& path, std::size_t count, std::size_t max,
                 std::string_view what) {
  if (count <= max) return true;
  faults.Reject(TooManyItems(path, count, max, what));
  return false;
}

}  // namespace

model::UiCapabilities DecodeUiCapabilities(wire::UiCapabilities::Reader in, Faults& faults) {
  const Path root;
  const Path services_path = root.Field("services");
  const Path sensors_path = root.Field("sensors");
  const Path settings_path = root.Field("settings");
  const auto services = in.getServices();
  const auto sensors = in.getSensors();
  const auto settings = in.getSettings();
  model::UiCapabilities out;
  if (!CountIsGood(faults, services_path, services.size(), kCapabilitiesMax, "services") ||
      !CountIsGood(faults, sensors_path, sensors.size(), kCapabilitiesMax, "sensors") ||
      !CountIsGood(faults, settings_path, settings.size(), kCapabilitiesMax, "settings")) {
    return out;
  }
  UniqueKeys service_names;
  for (unsigned i = 0; i < services.size() && !faults.rejected(); ++i) {
    out.services.push_back(
        DecodeService(services[i], services_path.Item(i), faults, service_names));
  }
  UniqueKeys sensor_keys;
  for (unsigned i = 0; i < sensors.size() && !faults.rejected(); ++i) {
    out.sensors.push_back(DecodeSensor(sensors[i], sensors_path.Item(i), faults, sensor_keys));
  }
  UniqueKeys setting_keys;
  for (unsigned i = 0; i < settings.size() && !faults.rejected(); ++i) {
    out.settings.push_back(DecodeSetting(settings[i], settings_path.Item(i), faults, setting_keys));
  }
  return out;
}

model::CurrentSettings DecodeCurrentSettings(capnp::List<wire::SettingUpdate>::Reader in,
                                             Faults& faults) {
  const Path root;
  model::CurrentSettings out;
  if (!CountIsGood(faults, root, in.size(), kSettingsMax, "settings")) return out;
  UniqueKeys keys;
  for (unsigned i = 0; i < in.size() && !faults.rejected(); ++i) {
    const Path path = root.Item(i);
    model::SettingUpdate update;
    update.key = keys.Required(faults, path.Field("key"), View(in[i].getKey()), kIdBytesMax);
    update.value = RequiredValue(faults, path.Field("value"), in[i].hasValue(), in[i].getValue());
    out.settings.push_back(std::move(update));
  }
  return out;
}

}  // namespace uplink::schema
