#include <forward_list>
#include <string>
#include <string_view>
#include <unordered_set>
#include <utility>

#include "schema/decode/decode.h"
#include "schema/decode/fields.h"
#include "schema/limits.h"
#include "schema/rules/numbers.h"
#include "schema/rules/texts.h"

/// Capabilities and settings: durable, so every violation rejects. Reading stops at the first one.
namespace uplink::schema {
namespace {

/// Names of one list, as they are kept; each may occur once.
class UniqueKeys {
 public:
  std::string Required(Violations& violations, const Path& path, std::string_view key,
                       std::size_t bytes_max) {
    std::string kept = RequiredText(violations, path, key, bytes_max);
    if (!violations.rejected() && !IsFirst(key, kept)) violations.Content(DuplicateKey(path, kept));
    return kept;
  }

 private:
  bool IsFirst(std::string_view sent, const std::string& kept) {
    // A replaced character makes a text longer.
    const bool as_sent = kept.size() == sent.size();
    return seen_.insert(as_sent ? sent : replaced_.emplace_front(kept)).second;
  }

  /// Views into the message, and of what was replaced.
  std::unordered_set<std::string_view> seen_;
  std::forward_list<std::string> replaced_;
};

model::Value RequiredValue(Violations& violations, const Path& path, bool there,
                           wire::Value::Reader in) {
  if (!there) {
    violations.Content(MissingField(path, "is a null pointer"));
    return {};
  }
  return JudgeValue(violations, path, in).value_or(model::Value());
}

/// Robots write a whole number as int, and the default of an enum as a string.
bool Matches(model::ValueType declared, model::ValueType type) {
  using model::ValueType;
  if (declared == type || !model::IsRecognized(declared)) return true;
  return (declared == ValueType::kNumber && type == ValueType::kInt) ||
         (declared == ValueType::kEnum && type == ValueType::kString);
}

std::optional<model::Range> JudgeRange(Violations& violations, const Path& min_path,
                                       const Path& max_path, const model::Range& raw) {
  const auto min = Finite(violations, min_path, raw.min);
  const auto max = Finite(violations, max_path, raw.max);
  if (!min || !max) return std::nullopt;
  if (*min > *max) violations.Content(MinAboveMax(min_path, *min, *max));
  return raw;
}

model::ServiceCapability DecodeService(wire::ServiceCapability::Reader in, const Path& path,
                                       Violations& violations, UniqueKeys& names) {
  model::ServiceCapability out;
  out.name = names.Required(violations, path.Field("name"), View(in.getName()), kNameBytesMax);
  out.description = DurableText(violations, path.Field("description"), View(in.getDescription()),
                                kDescriptionBytesMax);
  out.capability_type = Enum<model::CapabilityType>(violations, in.getCapabilityType());
  if (in.getHasConfirmationMessage()) {
    out.confirmation_message = DurableText(violations, path.Field("confirmationMessage"),
                                           View(in.getConfirmationMessage()), kDescriptionBytesMax);
  }
  out.state_key =
      DurableText(violations, path.Field("stateKey"), View(in.getStateKey()), kIdBytesMax);
  out.requires_role = Enum<model::Role>(violations, in.getRequiresRole());
  out.danger_level = Enum<model::DangerLevel>(violations, in.getDangerLevel());
  return out;
}

model::SensorCapability DecodeSensor(wire::SensorCapability::Reader in, const Path& path,
                                     Violations& violations, UniqueKeys& keys) {
  model::SensorCapability out;
  out.key = keys.Required(violations, path.Field("key"), View(in.getKey()), kIdBytesMax);
  out.label = DurableText(violations, path.Field("label"), View(in.getLabel()), kNameBytesMax);
  out.value_type = Enum<model::ValueType>(violations, in.getValueType());
  out.unit = DurableText(violations, path.Field("unit"), View(in.getUnit()), kNameBytesMax);
  if (in.getHasRange()) {
    out.range = JudgeRange(violations, path.Field("rangeMin"), path.Field("rangeMax"),
                           {.min = in.getRangeMin(), .max = in.getRangeMax()});
  }
  out.display_hint = Enum<model::DisplayHint>(violations, in.getDisplayHint());
  return out;
}

model::SettingDescriptor DecodeSetting(wire::SettingDescriptor::Reader in, const Path& path,
                                       Violations& violations, UniqueKeys& keys) {
  model::SettingDescriptor out;
  out.key = keys.Required(violations, path.Field("key"), View(in.getKey()), kIdBytesMax);
  out.label = DurableText(violations, path.Field("label"), View(in.getLabel()), kNameBytesMax);
  out.value_type = Enum<model::ValueType>(violations, in.getValueType());
  const Path default_path = path.Field("default");
  out.default_value = RequiredValue(violations, default_path, in.hasDefault(), in.getDefault());
  const model::ValueType type = model::TypeOf(out.default_value);
  if (!Matches(out.value_type, type)) {
    violations.Content(
        TypeMismatch(default_path, model::EnumText(type), model::EnumText(out.value_type)));
  }
  if (in.getHasRange() && in.hasRange()) {
    const Path range = path.Field("range");
    out.range = JudgeRange(violations, range.Field("min"), range.Field("max"),
                           {.min = in.getRange().getMin(), .max = in.getRange().getMax()});
  }
  if (in.getHasStep()) out.step = Finite(violations, path.Field("step"), in.getStep());
  return out;
}

bool CountIsGood(Violations& violations, const Path& path, std::size_t count, std::size_t max,
                 std::string_view what) {
  if (count <= max) return true;
  violations.Reject(TooManyItems(path, count, max, what));
  return false;
}

}  // namespace

model::UiCapabilities DecodeUiCapabilities(wire::UiCapabilities::Reader in,
                                           Violations& violations) {
  const Path root;
  const Path services_path = root.Field("services");
  const Path sensors_path = root.Field("sensors");
  const Path settings_path = root.Field("settings");
  const auto services = in.getServices();
  const auto sensors = in.getSensors();
  const auto settings = in.getSettings();
  model::UiCapabilities out;
  if (!CountIsGood(violations, services_path, services.size(), kCapabilitiesMax, "services") ||
      !CountIsGood(violations, sensors_path, sensors.size(), kCapabilitiesMax, "sensors") ||
      !CountIsGood(violations, settings_path, settings.size(), kCapabilitiesMax, "settings")) {
    return out;
  }
  UniqueKeys service_names;
  for (unsigned i = 0; i < services.size() && !violations.rejected(); ++i) {
    out.services.push_back(
        DecodeService(services[i], services_path.Item(i), violations, service_names));
  }
  UniqueKeys sensor_keys;
  for (unsigned i = 0; i < sensors.size() && !violations.rejected(); ++i) {
    out.sensors.push_back(DecodeSensor(sensors[i], sensors_path.Item(i), violations, sensor_keys));
  }
  UniqueKeys setting_keys;
  for (unsigned i = 0; i < settings.size() && !violations.rejected(); ++i) {
    out.settings.push_back(
        DecodeSetting(settings[i], settings_path.Item(i), violations, setting_keys));
  }
  return out;
}

model::CurrentSettings DecodeCurrentSettings(capnp::List<wire::SettingUpdate>::Reader in,
                                             Violations& violations) {
  const Path root;
  model::CurrentSettings out;
  if (!CountIsGood(violations, root, in.size(), kSettingsMax, "settings")) return out;
  UniqueKeys keys;
  for (unsigned i = 0; i < in.size() && !violations.rejected(); ++i) {
    const Path path = root.Item(i);
    model::SettingUpdate update;
    update.key = keys.Required(violations, path.Field("key"), View(in[i].getKey()), kIdBytesMax);
    update.value =
        RequiredValue(violations, path.Field("value"), in[i].hasValue(), in[i].getValue());
    out.settings.push_back(std::move(update));
  }
  return out;
}

}  // namespace uplink::schema
