#include "schema/decode/decode.h"
#include "schema/decode/fields.h"
#include "schema/limits.h"
#include "schema/rules/numbers.h"
#include "schema/rules/texts.h"

/// Host health, usage, consumables, directives and the agent itself.
namespace uplink::schema {

model::SystemHealth DecodeSystemHealth(wire::SystemHealth::Reader in, Violations& violations) {
  const Path root;
  const auto percent = [&](std::string_view name, float value) {
    return UnlessNan(value, [&](float v) { return Percent(violations, root.Field(name), v); });
  };
  const auto finite = [&](std::string_view name, float value) {
    return UnlessNan(value, [&](float v) { return Finite(violations, root.Field(name), v); });
  };
  model::SystemHealth out;
  out.unix_time_ms = Time(violations, in.getUnixTimeMs());
  out.device_id = LiveKey(violations, root.Field("deviceId"), View(in.getDeviceId()));
  out.cpu_pct = percent("cpuPct", in.getCpuPct());
  out.mem_pct = percent("memPct", in.getMemPct());
  out.disk_pct = percent("diskPct", in.getDiskPct());
  out.cpu_temp = finite("cpuTemp", in.getCpuTemp());
  out.signal_strength = finite("signalStrength", in.getSignalStrength());
  out.signal_quality = finite("signalQuality", in.getSignalQuality());
  if (!out.cpu_pct && !out.mem_pct && !out.disk_pct && !out.cpu_temp && !out.signal_strength &&
      !out.signal_quality) {
    violations.RejectIfAnyDropped();
  }
  return out;
}

model::UsageTelemetry DecodeUsageTelemetry(wire::UsageTelemetry::Reader in,
                                           Violations& violations) {
  const Path root;
  const auto total = [&](std::string_view name, double value) {
    return NotNegative(violations, root.Field(name), value);
  };
  model::UsageTelemetry out;
  out.unix_time_ms = Time(violations, in.getUnixTimeMs());
  out.total_distance_m = total("totalDistanceM", in.getTotalDistanceM());
  out.auto_distance_m = total("autoDistanceM", in.getAutoDistanceM());
  out.manual_distance_m = total("manualDistanceM", in.getManualDistanceM());
  out.uptime_total_s = total("uptimeTotalS", in.getUptimeTotalS());
  out.drive_time_total_s = total("driveTimeTotalS", in.getDriveTimeTotalS());
  out.auto_time_total_s = total("autoTimeTotalS", in.getAutoTimeTotalS());
  // The counters are never invalid: something is always left.
  out.mission_count_total = in.getMissionCountTotal();
  out.charge_cycles_total = in.getChargeCyclesTotal();
  out.reboot_count = in.getRebootCount();
  out.last_reboot_unix_time_ms = Time(violations, in.getLastRebootUnixTimeMs());
  return out;
}

model::ConsumableStatus DecodeConsumableStatus(wire::ConsumableStatus::Reader in,
                                               Violations& violations) {
  const Path root;
  model::ConsumableStatus out;
  out.unix_time_ms = Time(violations, in.getUnixTimeMs());
  out.kind = RequiredLiveKey(violations, root.Field("kind"), View(in.getKind()));
  out.tank_id = LiveKey(violations, root.Field("tankId"), View(in.getTankId()));
  out.level_pct = Percent(violations, root.Field("levelPct"), in.getLevelPct());
  out.amount_remaining =
      NotNegative(violations, root.Field("amountRemaining"), in.getAmountRemaining());
  out.unit = Text(violations, root.Field("unit"), View(in.getUnit()), kNameBytesMax);
  // isCritical is never invalid: something is always left.
  out.is_critical = in.getIsCritical();
  return out;
}

model::SpatialDirectiveStatus DecodeSpatialDirectiveStatus(wire::SpatialDirectiveStatus::Reader in,
                                                           Violations& violations) {
  const Path root;
  model::SpatialDirectiveStatus out;
  out.directive_id =
      RequiredLiveKey(violations, root.Field("directiveId"), View(in.getDirectiveId()));
  out.last_eval_time_ms = Time(violations, in.getLastEvalTimeMs());
  // Active and insideZone are never invalid: something is always left.
  out.active = in.getActive();
  out.inside_zone = in.getInsideZone();
  if (in.getHasDistanceToZoneM()) {
    out.distance_to_zone_m =
        NotNegative(violations, root.Field("distanceToZoneM"), in.getDistanceToZoneM());
  }
  return out;
}

model::AgentInfo DecodeAgentInfo(wire::AgentInfo::Reader in, Violations& violations) {
  const Path root;
  const auto text = [&](std::string_view name, capnp::Text::Reader value) {
    return DurableText(violations, root.Field(name), View(value), kNameBytesMax);
  };
  model::AgentInfo out;
  out.agent_version = text("agentVersion", in.getAgentVersion());
  if (in.getHasSoftwareVersion()) {
    out.software_version = text("softwareVersion", in.getSoftwareVersion());
  }
  if (in.getHasOsInfo()) out.os_info = text("osInfo", in.getOsInfo());
  if (in.getHasUptimeS()) out.uptime_s = in.getUptimeS();
  return out;
}

}  // namespace uplink::schema
