#include "schema/json/fields.h"
#include "schema/json/render.h"

namespace uplink::json {

boost::json::object Render(const model::SystemHealth& body) {
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

boost::json::object Render(const model::UsageTelemetry& body) {
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

boost::json::object Render(const model::ConsumableStatus& body) {
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

boost::json::object Render(const model::SpatialDirectiveStatus& body) {
  return Fields()
      .Set("directiveId", body.directive_id)
      .Set("lastEvalTimeMs", body.last_eval_time_ms)
      .Set("active", body.active)
      .Set("insideZone", body.inside_zone)
      .SetIf("distanceToZoneM", body.distance_to_zone_m)
      .Take();
}

boost::json::object Render(const model::AgentInfo& body) {
  return Fields()
      .Set("agentVersion", body.agent_version)
      .SetIf("softwareVersion", body.software_version)
      .SetIf("osInfo", body.os_info)
      .SetIf("uptimeS", body.uptime_s)
      .Take();
}

}  // namespace uplink::json
