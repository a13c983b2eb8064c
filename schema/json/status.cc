#include "schema/json/fields.h"
#include "schema/json/render.h"

namespace uplink::json {
namespace {

using boost::json::object;

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

}  // namespace

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

}  // namespace uplink::json
