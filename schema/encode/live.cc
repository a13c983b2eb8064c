#include <limits>

#include "schema/encode/encode_body.h"

namespace uplink::schema {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr float kNanF = std::numeric_limits<float>::quiet_NaN();

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
  auto ids = out.initIds(static_cast<unsigned>(in.ids.size()));
  for (unsigned i = 0; i < ids.size(); ++i) ids.set(i, Text(in.ids[i]));
}

}  // namespace

void EncodePose(const model::Pose& in, wire::Pose::Builder out) {
  out.setLatDeg(in.lat_deg);
  out.setLonDeg(in.lon_deg);
  out.setAltitudeM(in.altitude_m.value_or(kNan));
  out.setHeadingDeg(in.heading_deg.value_or(kNan));
}

void EncodeMember(const model::MotionTelemetry& in, wire::UplinkMsg::Builder message) {
  auto out = message.initMotionTelemetry();
  out.setUnixTimeMs(in.unix_time_ms);
  out.setHasPose(in.pose.has_value());
  if (in.pose) EncodePose(*in.pose, out.initPose());
  out.setHasVelocity(in.velocity.has_value());
  if (in.velocity) {
    auto velocity = out.initVelocity();
    velocity.setLinearMps(in.velocity->linear_mps.value_or(kNanF));
    velocity.setAngularRps(in.velocity->angular_rps.value_or(kNanF));
  }
  out.setHasGpsFixType(in.gps_fix_type.has_value());
  if (in.gps_fix_type) out.setGpsFixType(Enum<wire::GpsFixType>(*in.gps_fix_type));
  out.setGpsSource(Enum<wire::GpsSource>(in.gps_source));
}

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

void EncodeMember(const model::TelemetryExtras& in, wire::UplinkMsg::Builder message) {
  auto out = message.initTelemetryExtras();
  out.setUnixTimeMs(in.unix_time_ms);
  auto kv = out.initKv(static_cast<unsigned>(in.kv.size()));
  for (unsigned i = 0; i < kv.size(); ++i) {
    kv[i].setKey(Text(in.kv[i].key));
    EncodeValue(in.kv[i].value, kv[i].initValue());
    kv[i].setHasUnixTimeMs(in.kv[i].unix_time_ms.has_value());
    kv[i].setUnixTimeMs(in.kv[i].unix_time_ms.value_or(0));
  }
}

void EncodeMember(const model::SystemHealth& in, wire::UplinkMsg::Builder message) {
  auto out = message.initSystemHealth();
  out.setUnixTimeMs(in.unix_time_ms);
  out.setDeviceId(Text(in.device_id));
  out.setCpuPct(in.cpu_pct.value_or(kNanF));
  out.setMemPct(in.mem_pct.value_or(kNanF));
  out.setDiskPct(in.disk_pct.value_or(kNanF));
  out.setCpuTemp(in.cpu_temp.value_or(kNanF));
  out.setSignalStrength(in.signal_strength.value_or(kNanF));
  out.setSignalQuality(in.signal_quality.value_or(kNanF));
}

void EncodeMember(const model::UsageTelemetry& in, wire::UplinkMsg::Builder message) {
  auto out = message.initUsageTelemetry();
  out.setUnixTimeMs(in.unix_time_ms);
  out.setTotalDistanceM(in.total_distance_m.value_or(kNan));
  out.setAutoDistanceM(in.auto_distance_m.value_or(kNan));
  out.setManualDistanceM(in.manual_distance_m.value_or(kNan));
  out.setUptimeTotalS(in.uptime_total_s.value_or(kNan));
  out.setDriveTimeTotalS(in.drive_time_total_s.value_or(kNan));
  out.setAutoTimeTotalS(in.auto_time_total_s.value_or(kNan));
  out.setMissionCountTotal(in.mission_count_total);
  out.setChargeCyclesTotal(in.charge_cycles_total);
  out.setRebootCount(in.reboot_count);
  out.setLastRebootUnixTimeMs(in.last_reboot_unix_time_ms);
}

void EncodeMember(const model::ConsumableStatus& in, wire::UplinkMsg::Builder message) {
  auto out = message.initConsumableStatus();
  out.setUnixTimeMs(in.unix_time_ms);
  out.setKind(Text(in.kind));
  out.setTankId(Text(in.tank_id));
  out.setLevelPct(in.level_pct.value_or(kNanF));
  out.setAmountRemaining(in.amount_remaining.value_or(kNanF));
  if (in.unit) out.setUnit(Text(*in.unit));
  out.setIsCritical(in.is_critical);
}

void EncodeMember(const model::SpatialDirectiveStatus& in, wire::UplinkMsg::Builder message) {
  auto out = message.initSpatialDirectiveStatus();
  out.setDirectiveId(Text(in.directive_id));
  out.setLastEvalTimeMs(in.last_eval_time_ms);
  out.setActive(in.active);
  out.setInsideZone(in.inside_zone);
  out.setHasDistanceToZoneM(in.distance_to_zone_m.has_value());
  out.setDistanceToZoneM(in.distance_to_zone_m.value_or(0));
}

}  // namespace uplink::schema
