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
                                   Faults& faults) {
  const auto finite = [&](std::string_view name, float value) {
    return Finite(faults, path.Field(name), value);
  };
  model::BatteryStatus out;
  out.soc_pct = Percent(faults, path.Field("socPct"), in.getSocPct());
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
      return InRange(faults, path.Field("temperature"), v, kTemperature);
    });
  }
  out.power_supply_status = Enum<model::PowerSupplyStatus>(faults, in.getPowerSupplyStatus());
  out.power_supply_health = Enum<model::PowerSupplyHealth>(faults, in.getPowerSupplyHealth());
  out.power_supply_technology =
      Enum<model::PowerSupplyTechnology>(faults, in.getPowerSupplyTechnology());
  return out;
}

model::FuelStatus DecodeFuel(wire::FuelStatus::Reader in, const Path& path, Faults& faults) {
  const auto finite = [&](std::string_view name, float value) {
    return Finite(faults, path.Field(name), value);
  };
  const auto unit = [&](std::string_view name, capnp::Text::Reader text) {
    return Text(faults, path.Field(name), View(text), kNameBytesMax);
  };
  model::FuelStatus out;
  out.level_pct = Percent(faults, path.Field("levelPct"), in.getLevelPct());
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

model::EStop DecodeEStop(wire::EStop::Reader in, const Path& path, Faults& faults) {
  model::EStop out;
  out.unix_time_ms = Time(faults, in.getUnixTimeMs());
  out.active = in.getActive();
  const auto ids = in.getIds();
  const Path ids_path = path.Field("ids");
  if (ids.size() > kEStopIdsMax) {
    faults.Reject(TooManyItems(ids_path, ids.size(), kEStopIdsMax, "e-stop ids"));
    return out;
  }
  out.ids.reserve(ids.size());
  for (unsigned i = 0; i < ids.size(); ++i) {
    if (auto id = Text(faults, ids_path.Item(i), View(ids[i]), kIdBytesMax)) {
      out.ids.push_back(*std::move(id));
    }
  }
  return out;
}

}  // namespace

model::StatusTelemetry DecodeStatusTelemetry(wire::StatusTelemetry::Reader in, Faults& faults) {
  const Path root;
  model::StatusTelemetry out;
  out.unix_time_ms = Time(faults, in.getUnixTimeMs());
  if (in.getHasBattery()) {
    const Path path = root.Field("battery");
    if (in.hasBattery()) {
      out.battery = DecodeBattery(in.getBattery(), path, faults);
    } else {
      faults.Content(MissingField(path, "is announced and a null pointer"));
    }
  }
  if (in.getHasMode()) out.mode = Enum<model::RobotMode>(faults, in.getMode());
  if (in.hasEstop()) out.estop = DecodeEStop(in.getEstop(), root.Field("estop"), faults);
  out.faulted = in.getFaulted();
  out.mission_active = in.getMissionActive();
  out.status = CutText(faults, root.Field("status"), View(in.getStatus()), kDescriptionBytesMax);
  if (in.getHasFuel()) {
    const Path path = root.Field("fuel");
    if (in.hasFuel()) {
      out.fuel = DecodeFuel(in.getFuel(), path, faults);
    } else {
      faults.Content(MissingField(path, "is announced and a null pointer"));
    }
  }
  if (in.getHasRangeRemaining()) {
    out.range_remaining = NotNegative(faults, root.Field("rangeRemaining"), in.getRangeRemaining());
  }
  if (in.getHasRuntimeRemaining()) {
    out.runtime_remaining =
        NotNegative(faults, root.Field("runtimeRemaining"), in.getRuntimeRemaining());
  }
  // E-stop, faulted and missionActive are never at fault: something is always left.
  return out;
}

}  // namespace uplink::schema
