#include <utility>

#include "schema/decode/decode.h"
#include "schema/decode/fields.h"
#include "schema/limits.h"
#include "schema/rules/numbers.h"
#include "schema/rules/texts.h"

namespace uplink::schema {
namespace {

constexpr Bounds kTemperature = {kTemperatureCMin, kTemperatureCMax};

model::BatteryStatus DecodeBattery(wire::BatteryStatus::Reader in, const Path& path,
                                   Violations& violations) {
  const auto finite = [&](std::string_view name, float value) {
    return Finite(violations, path.Field(name), value);
  };
  model::BatteryStatus out;
  out.soc_pct = Percent(violations, path.Field("socPct"), in.getSocPct());
  if (in.getHasVoltageV()) out.voltage_v = finite("voltageV", in.getVoltageV());
  if (in.getHasCurrentA()) {
    out.current_a = UnlessNan(in.getCurrentA(), [&](float v) { return finite("currentA", v); });
  }
  if (in.getHasChargeAh()) out.charge_ah = finite("chargeAh", in.getChargeAh());
  if (in.getHasCapacityAh()) out.capacity_ah = finite("capacityAh", in.getCapacityAh());
  if (in.getHasDesignCapacityAh()) {
    out.design_capacity_ah = finite("designCapacityAh", in.getDesignCapacityAh());
  }
  if (in.getHasTemperature()) {
    out.temperature = UnlessNan(in.getTemperature(), [&](float v) {
      return InRange(violations, path.Field("temperature"), v, kTemperature);
    });
  }
  out.power_supply_status = Enum<model::PowerSupplyStatus>(violations, in.getPowerSupplyStatus());
  out.power_supply_health = Enum<model::PowerSupplyHealth>(violations, in.getPowerSupplyHealth());
  out.power_supply_technology =
      Enum<model::PowerSupplyTechnology>(violations, in.getPowerSupplyTechnology());
  return out;
}

model::FuelStatus DecodeFuel(wire::FuelStatus::Reader in, const Path& path,
                             Violations& violations) {
  const auto finite = [&](std::string_view name, float value) {
    return Finite(violations, path.Field(name), value);
  };
  const auto unit = [&](std::string_view name, capnp::Text::Reader text) {
    return Text(violations, path.Field(name), View(text), kNameBytesMax);
  };
  model::FuelStatus out;
  out.level_pct = Percent(violations, path.Field("levelPct"), in.getLevelPct());
  if (in.getHasVolumeRemaining()) {
    out.volume_remaining = finite("volumeRemaining", in.getVolumeRemaining());
  }
  if (in.getHasCapacity()) out.capacity = finite("capacity", in.getCapacity());
  if (in.getHasVolumeUnit()) out.volume_unit = unit("volumeUnit", in.getVolumeUnit());
  if (in.getHasEfficiency()) out.efficiency = finite("efficiency", in.getEfficiency());
  if (in.getHasEfficiencyUnit()) {
    out.efficiency_unit = unit("efficiencyUnit", in.getEfficiencyUnit());
  }
  out.is_refueling = in.getIsRefueling();
  return out;
}

model::EStop DecodeEStop(wire::EStop::Reader in, const Path& path, Violations& violations) {
  model::EStop out;
  out.unix_time_ms = Time(violations, in.getUnixTimeMs());
  out.active = in.getActive();
  const auto ids = in.getIds();
  const Path ids_path = path.Field("ids");
  if (ids.size() > kEStopIdsMax) {
    violations.Reject(TooManyItems(ids_path, ids.size(), kEStopIdsMax, "e-stop ids"));
    return out;
  }
  out.ids.reserve(ids.size());
  for (unsigned i = 0; i < ids.size(); ++i) {
    if (auto id = Text(violations, ids_path.Item(i), View(ids[i]), kIdBytesMax)) {
      out.ids.push_back(*std::move(id));
    }
  }
  return out;
}

}  // namespace

model::StatusTelemetry DecodeStatusTelemetry(wire::StatusTelemetry::Reader in,
                                             Violations& violations) {
  const Path root;
  model::StatusTelemetry out;
  out.unix_time_ms = Time(violations, in.getUnixTimeMs());
  if (in.getHasBattery()) {
    const Path path = root.Field("battery");
    if (in.hasBattery()) {
      out.battery = DecodeBattery(in.getBattery(), path, violations);
    } else {
      violations.Content(MissingField(path, "is announced and a null pointer"));
    }
  }
  if (in.getHasMode()) out.mode = Enum<model::RobotMode>(violations, in.getMode());
  if (in.hasEstop()) out.estop = DecodeEStop(in.getEstop(), root.Field("estop"), violations);
  out.faulted = in.getFaulted();
  out.mission_active = in.getMissionActive();
  out.status =
      CutText(violations, root.Field("status"), View(in.getStatus()), kDescriptionBytesMax);
  if (in.getHasFuel()) {
    const Path path = root.Field("fuel");
    if (in.hasFuel()) {
      out.fuel = DecodeFuel(in.getFuel(), path, violations);
    } else {
      violations.Content(MissingField(path, "is announced and a null pointer"));
    }
  }
  if (in.getHasRangeRemaining()) {
    out.range_remaining =
        NotNegative(violations, root.Field("rangeRemaining"), in.getRangeRemaining());
  }
  if (in.getHasRuntimeRemaining()) {
    out.runtime_remaining =
        NotNegative(violations, root.Field("runtimeRemaining"), in.getRuntimeRemaining());
  }
  // E-stop, faulted and missionActive are never invalid: something is always left.
  return out;
}

}  // namespace uplink::schema
