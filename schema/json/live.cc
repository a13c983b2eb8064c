#include "schema/json/fields.h"
#include "schema/json/render.h"

namespace uplink::json {
namespace {

using boost::json::object;

object RenderVelocity(const model::VelTwist& velocity) {
  return Fields()
      .SetIf("linearMps", velocity.linear_mps)
      .SetIf("angularRps", velocity.angular_rps)
      .Take();
}

object RenderBattery(const model::BatteryStatus& battery) {
  return Fields()
      .SetIf("socPct", battery.soc_pct)
      .SetIf("voltageV", battery.voltage_v)
      .SetIf("currentA", battery.current_a)
      .SetIf("chargeAh", battery.charge_ah)
      .SetIf("capacityAh", battery.capacity_ah)
      .SetIf("designCapacityAh", battery.design_capacity_ah)
      .SetIf("temperature", battery.temperature)
      .Set("powerSupplyStatus", battery.power_supply_status)
      .Set("powerSupplyHealth", battery.power_supply_health)
      .Set("powerSupplyTechnology", battery.power_supply_technology)
      .Take();
}

object RenderFuel(const model::FuelStatus& fuel) {
  return Fields()
      .SetIf("levelPct", fuel.level_pct)
      .SetIf("volumeRemaining", fuel.volume_remaining)
      .SetIf("capacity", fuel.capacity)
      .SetIf("volumeUnit", fuel.volume_unit)
      .SetIf("efficiency", fuel.efficiency)
      .SetIf("efficiencyUnit", fuel.efficiency_unit)
      .Set("isRefueling", fuel.is_refueling)
      .Take();
}

object RenderEStop(const model::EStop& estop) {
  return Fields()
      .Set("unixTimeMs", estop.unix_time_ms)
      .Set("active", estop.active)
      .Set("ids", ListOf(estop.ids, [](const std::string& id) { return id; }))
      .Take();
}

object RenderReading(const model::SensorReading& reading) {
  return Fields()
      .Set("key", reading.key)
      .Set("value", Render(reading.value))
      .SetIf("unixTimeMs", reading.unix_time_ms)
      .Take();
}

}  // namespace

object Render(const model::Pose& pose) {
  return Fields()
      .Set("latDeg", pose.lat_deg)
      .Set("lonDeg", pose.lon_deg)
      .SetIf("altitudeM", pose.altitude_m)
      .SetIf("headingDeg", pose.heading_deg)
      .Take();
}

object Render(const model::MotionTelemetry& body) {
  Fields fields;
  fields.Set("unixTimeMs", body.unix_time_ms);
  if (body.pose) fields.Set("pose", Render(*body.pose));
  if (body.velocity) fields.Set("velocity", RenderVelocity(*body.velocity));
  return fields.SetIf("gpsFixType", body.gps_fix_type).Set("gpsSource", body.gps_source).Take();
}

object Render(const model::StatusTelemetry& body) {
  Fields fields;
  fields.Set("unixTimeMs", body.unix_time_ms);
  if (body.battery) fields.Set("battery", RenderBattery(*body.battery));
  fields.SetIf("mode", body.mode);
  if (body.estop) fields.Set("estop", RenderEStop(*body.estop));
  fields.Set("faulted", body.faulted)
      .Set("missionActive", body.mission_active)
      .SetIf("status", body.status);
  if (body.fuel) fields.Set("fuel", RenderFuel(*body.fuel));
  return fields.SetIf("rangeRemaining", body.range_remaining)
      .SetIf("runtimeRemaining", body.runtime_remaining)
      .Take();
}

object Render(const model::TelemetryExtras& body) {
  return Fields()
      .Set("unixTimeMs", body.unix_time_ms)
      .Set("kv", ListOf(body.kv, RenderReading))
      .Take();
}

object Render(const model::SystemHealth& body) {
  return Fields()
      .Set("unixTimeMs", body.unix_time_ms)
      .Set("deviceId", body.device_id)
      .SetIf("cpuPct", body.cpu_pct)
      .SetIf("memPct", body.mem_pct)
      .SetIf("diskPct", body.disk_pct)
      .SetIf("cpuTemp", body.cpu_temp)
      .SetIf("signalStrength", body.signal_strength)
      .SetIf("signalQuality", body.signal_quality)
      .Take();
}

object Render(const model::UsageTelemetry& body) {
  return Fields()
      .Set("unixTimeMs", body.unix_time_ms)
      .SetIf("totalDistanceM", body.total_distance_m)
      .SetIf("autoDistanceM", body.auto_distance_m)
      .SetIf("manualDistanceM", body.manual_distance_m)
      .SetIf("uptimeTotalS", body.uptime_total_s)
      .SetIf("driveTimeTotalS", body.drive_time_total_s)
      .SetIf("autoTimeTotalS", body.auto_time_total_s)
      .Set("missionCountTotal", body.mission_count_total)
      .Set("chargeCyclesTotal", body.charge_cycles_total)
      .Set("rebootCount", body.reboot_count)
      .Set("lastRebootUnixTimeMs", body.last_reboot_unix_time_ms)
      .Take();
}

object Render(const model::ConsumableStatus& body) {
  return Fields()
      .Set("unixTimeMs", body.unix_time_ms)
      .Set("kind", body.kind)
      .Set("tankId", body.tank_id)
      .SetIf("levelPct", body.level_pct)
      .SetIf("amountRemaining", body.amount_remaining)
      .SetIf("unit", body.unit)
      .Set("isCritical", body.is_critical)
      .Take();
}

object Render(const model::SpatialDirectiveStatus& body) {
  return Fields()
      .Set("directiveId", body.directive_id)
      .Set("lastEvalTimeMs", body.last_eval_time_ms)
      .Set("active", body.active)
      .Set("insideZone", body.inside_zone)
      .SetIf("distanceToZoneM", body.distance_to_zone_m)
      .Take();
}

}  // namespace uplink::json
