#include "schema/encode/encode_body.h"

namespace uplink::schema {
namespace {

void EncodeBattery(const model::BatteryStatus& in, wire::BatteryStatus::Builder out) {
  out.setSocPct(in.soc_pct.value_or(kNanF));
  out.setHasVoltageV(in.voltage_v.has_value());
  out.setVoltageV(in.voltage_v.value_or(0));
  out.setHasCurrentA(in.current_a.has_value());
  out.setCurrentA(in.current_a.value_or(0));
  out.setHasChargeAh(in.charge_ah.has_value());
  out.setChargeAh(in.charge_ah.value_or(0));
  out.setHasCapacityAh(in.capacity_ah.has_value());
  out.setCapacityAh(in.capacity_ah.value_or(0));
  out.setHasDesignCapacityAh(in.design_capacity_ah.has_value());
  out.setDesignCapacityAh(in.design_capacity_ah.value_or(0));
  out.setHasTemperature(in.temperature.has_value());
  out.setTemperature(in.temperature.value_or(0));
  out.setPowerSupplyStatus(Enum<wire::PowerSupplyStatus>(in.power_supply_status));
  out.setPowerSupplyHealth(Enum<wire::PowerSupplyHealth>(in.power_supply_health));
  out.setPowerSupplyTechnology(Enum<wire::PowerSupplyTechnology>(in.power_supply_technology));
}

void EncodeFuel(const model::FuelStatus& in, wire::FuelStatus::Builder out) {
  out.setLevelPct(in.level_pct.value_or(kNanF));
  out.setHasVolumeRemaining(in.volume_remaining.has_value());
  out.setVolumeRemaining(in.volume_remaining.value_or(0));
  out.setHasCapacity(in.capacity.has_value());
  out.setCapacity(in.capacity.value_or(0));
  out.setHasVolumeUnit(in.volume_unit.has_value());
  if (in.volume_unit) out.setVolumeUnit(Text(*in.volume_unit));
  out.setHasEfficiency(in.efficiency.has_value());
  out.setEfficiency(in.efficiency.value_or(0));
  out.setHasEfficiencyUnit(in.efficiency_unit.has_value());
  if (in.efficiency_unit) out.setEfficiencyUnit(Text(*in.efficiency_unit));
  out.setIsRefueling(in.is_refueling);
}

void EncodeEStop(const model::EStop& in, wire::EStop::Builder out) {
  out.setUnixTimeMs(in.unix_time_ms);
  out.setActive(in.active);
  auto ids = out.initIds(Count(in.ids));
  for (unsigned i = 0; i < ids.size(); ++i) ids.set(i, Text(in.ids[i]));
}

}  // namespace

void EncodeMember(const model::StatusTelemetry& in, wire::UplinkMsg::Builder message) {
  auto out = message.initStatusTelemetry();
  out.setUnixTimeMs(in.unix_time_ms);
  out.setHasBattery(in.battery.has_value());
  if (in.battery) EncodeBattery(*in.battery, out.initBattery());
  out.setHasMode(in.mode.has_value());
  if (in.mode) out.setMode(Enum<wire::RobotMode>(*in.mode));
  if (in.estop) EncodeEStop(*in.estop, out.initEstop());
  out.setFaulted(in.faulted);
  out.setMissionActive(in.mission_active);
  if (in.status) out.setStatus(Text(*in.status));
  out.setHasFuel(in.fuel.has_value());
  if (in.fuel) EncodeFuel(*in.fuel, out.initFuel());
  out.setHasRangeRemaining(in.range_remaining.has_value());
  out.setRangeRemaining(in.range_remaining.value_or(0));
  out.setHasRuntimeRemaining(in.runtime_remaining.has_value());
  out.setRuntimeRemaining(in.runtime_remaining.value_or(0));
}

}  // namespace uplink::schema
