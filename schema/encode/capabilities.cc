#include "schema/encode/encode_body.h"

namespace uplink::schema {
namespace {

void EncodeService(const model::ServiceCapability& in, wire::ServiceCapability::Builder out) {
  out.setName(Text(in.name));
  out.setDescription(Text(in.description));
  out.setCapabilityType(Enum<wire::CapabilityType>(in.capability_type));
  out.setHasConfirmationMessage(in.confirmation_message.has_value());
  if (in.confirmation_message) out.setConfirmationMessage(Text(*in.confirmation_message));
  out.setStateKey(Text(in.state_key));
  out.setRequiresRole(Enum<wire::Role>(in.requires_role));
  out.setDangerLevel(Enum<wire::DangerLevel>(in.danger_level));
}

void EncodeSensor(const model::SensorCapability& in, wire::SensorCapability::Builder out) {
  out.setKey(Text(in.key));
  out.setLabel(Text(in.label));
  out.setValueType(Enum<wire::ValueType>(in.value_type));
  out.setUnit(Text(in.unit));
  out.setHasRange(in.range.has_value());
  if (in.range) {
    out.setRangeMin(in.range->min);
    out.setRangeMax(in.range->max);
  }
  out.setDisplayHint(Enum<wire::DisplayHint>(in.display_hint));
}

void EncodeSetting(const model::SettingDescriptor& in, wire::SettingDescriptor::Builder out) {
  out.setKey(Text(in.key));
  out.setLabel(Text(in.label));
  out.setValueType(Enum<wire::ValueType>(in.value_type));
  EncodeValue(in.default_value, out.initDefault());
  out.setHasRange(in.range.has_value());
  if (in.range) {
    auto range = out.initRange();
    range.setMin(in.range->min);
    range.setMax(in.range->max);
  }
  out.setHasStep(in.step.has_value());
  out.setStep(in.step.value_or(0));
}

}  // namespace

void EncodeMember(const model::UiCapabilities& in, wire::UplinkMsg::Builder message) {
  auto out = message.initUiCapabilities();
  auto services = out.initServices(Count(in.services));
  for (unsigned i = 0; i < services.size(); ++i) EncodeService(in.services[i], services[i]);
  auto sensors = out.initSensors(Count(in.sensors));
  for (unsigned i = 0; i < sensors.size(); ++i) EncodeSensor(in.sensors[i], sensors[i]);
  auto settings = out.initSettings(Count(in.settings));
  for (unsigned i = 0; i < settings.size(); ++i) EncodeSetting(in.settings[i], settings[i]);
}

void EncodeMember(const model::CurrentSettings& in, wire::UplinkMsg::Builder message) {
  auto out = message.initCurrentSettings(Count(in.settings));
  for (unsigned i = 0; i < out.size(); ++i) {
    out[i].setKey(Text(in.settings[i].key));
    EncodeValue(in.settings[i].value, out[i].initValue());
  }
}

}  // namespace uplink::schema
