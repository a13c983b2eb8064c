#include "schema/encode/encode_body.h"

namespace uplink::schema {

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

void EncodeMember(const model::AgentInfo& in, wire::UplinkMsg::Builder message) {
  auto out = message.initAgentInfo();
  out.setAgentVersion(Text(in.agent_version));
  out.setHasSoftwareVersion(in.software_version.has_value());
  if (in.software_version) out.setSoftwareVersion(Text(*in.software_version));
  out.setHasOsInfo(in.os_info.has_value());
  if (in.os_info) out.setOsInfo(Text(*in.os_info));
  out.setHasUptimeS(in.uptime_s.has_value());
  out.setUptimeS(in.uptime_s.value_or(0));
}

}  // namespace uplink::schema
