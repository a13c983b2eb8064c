#include "tools/uplink-fleet/robot/behaviour/equipment.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

namespace uplink::synthetic {
namespace {

constexpr std::array<const char*, 2> kDeviceIds = {"main", "vision"};
constexpr std::array<const char*, 2> kTankIds = {"front", "rear"};
constexpr std::array<const char*, 2> kZoneIds = {"zone-slow", "zone-quiet"};
constexpr double kZoneRadiusM = 40;
constexpr double kCriticalPct = 10;
constexpr double kTankLitres = 25;

}  // namespace

Equipment::Equipment(Seeded random)
    : random_(random),
      uptime_s_(random_.Between(60, 200'000)),
      level_pct_{random_.Between(5, 100), random_.Between(5, 100)},
      extras_(2, random_.Between(0, 2)),
      health_(5, random_.Between(0, 5)),
      usage_(10, random_.Between(0, 5)),
      consumable_(5, random_.Between(0, 5)),
      directive_(3, random_.Between(0, 3)) {}

void Equipment::Advance(const Moment& moment, const Facts& facts, const Route& route, Outbox& out) {
  uptime_s_ += moment.dt_s;
  deck_c_ += (facts.mission_active ? 60 - deck_c_ : 25 - deck_c_) * std::min(1.0, moment.dt_s / 30);
  for (double& level : level_pct_) {
    if (facts.mission_active) level -= moment.dt_s / 3;
    if (level <= 0) level = 100;
  }
  if (info_.Passed(moment.dt_s)) Info(out);
  if (extras_.Passed(moment.dt_s)) Extras(moment, facts, out);
  if (health_.Passed(moment.dt_s)) Health(moment, ++turn_ % kDevices, out);
  if (usage_.Passed(moment.dt_s)) Usage(moment, facts, out);
  if (consumable_.Passed(moment.dt_s)) Consumable(moment, ++turn_ % kTanks, out);
  if (directive_.Passed(moment.dt_s)) Directive(moment, facts, route, ++turn_ % kZones, out);
}

void Equipment::All(const Moment& moment, const Facts& facts, const Route& route, Outbox& out) {
  Extras(moment, facts, out);
  Usage(moment, facts, out);
  for (std::size_t i = 0; i < kDevices; ++i) Health(moment, i, out);
  for (std::size_t i = 0; i < kTanks; ++i) Consumable(moment, i, out);
  for (std::size_t i = 0; i < kZones; ++i) Directive(moment, facts, route, i, out);
}

void Equipment::Info(Outbox& out) {
  out.emplace_back(model::AgentInfo{.agent_version = "uplink-fleet " UPLINK_VERSION,
                                    .software_version = "synthetic 1.0",
                                    .os_info = "none: this robot is not real",
                                    .uptime_s = static_cast<std::uint64_t>(uptime_s_)});
}

void Equipment::Extras(const Moment& moment, const Facts& facts, Outbox& out) {
  const bool turning = facts.mission_active && facts.may_drive();
  model::TelemetryExtras extras;
  extras.unix_time_ms = moment.now_ms;
  extras.kv = {{.key = "deckRpm",
                .value = static_cast<std::int32_t>(turning ? 2800 + random_.Below(200) : 0),
                .unix_time_ms = moment.now_ms},
               {.key = "deckTemperature", .value = deck_c_, .unix_time_ms = std::nullopt},
               {.key = "blade", .value = turning, .unix_time_ms = std::nullopt},
               {.key = "gear",
                .value = model::EnumName{turning ? "low" : "neutral"},
                .unix_time_ms = std::nullopt},
               {.key = "note",
                .value = std::string(turning ? facts.mission_name : "waits"),
                .unix_time_ms = std::nullopt}};
  out.emplace_back(std::move(extras));
}

void Equipment::Health(const Moment& moment, std::size_t device, Outbox& out) {
  model::SystemHealth health;
  health.unix_time_ms = moment.now_ms;
  health.device_id = kDeviceIds.at(device);
  health.cpu_pct = static_cast<float>(random_.Between(10, 80));
  health.mem_pct = static_cast<float>(random_.Between(30, 60));
  health.disk_pct = 41.5F;
  health.cpu_temp = static_cast<float>(random_.Between(40, 75));
  // The second computer has no radio: its signal is not measured.
  if (device == 0) {
    health.signal_strength = static_cast<float>(random_.Between(-85, -50));
    health.signal_quality = static_cast<float>(random_.Between(30, 70));
  }
  out.emplace_back(std::move(health));
}

void Equipment::Usage(const Moment& moment, const Facts& facts, Outbox& out) {
  model::UsageTelemetry usage;
  usage.unix_time_ms = moment.now_ms;
  usage.total_distance_m = 120'000 + facts.distance_m;
  usage.auto_distance_m = 100'000 + facts.distance_m;
  usage.manual_distance_m = 20'000;
  usage.uptime_total_s = 900'000 + uptime_s_;
  usage.drive_time_total_s = 90'000 + facts.driven_s;
  usage.auto_time_total_s = 80'000 + facts.driven_s;
  usage.mission_count_total = 310 + facts.missions_done;
  usage.charge_cycles_total = 120 + facts.charge_cycles;
  usage.reboot_count = 17;
  usage.last_reboot_unix_time_ms = moment.now_ms - static_cast<std::int64_t>(uptime_s_ * 1000);
  out.emplace_back(usage);
}

void Equipment::Consumable(const Moment& moment, std::size_t tank, Outbox& out) {
  const double level = level_pct_.at(tank);
  out.emplace_back(
      model::ConsumableStatus{.unix_time_ms = moment.now_ms,
                              .kind = "paint",
                              .tank_id = kTankIds.at(tank),
                              .level_pct = static_cast<float>(level),
                              .amount_remaining = static_cast<float>(kTankLitres * level / 100),
                              .unit = "l",
                              .is_critical = level < kCriticalPct});
}

void Equipment::Directive(const Moment& moment, const Facts& facts, const Route& route,
                          std::size_t zone, Outbox& out) {
  const model::GeoPoint2 centre = Offset(route.origin(), zone == 0 ? 60 : -60, 0);
  const double north_m = (facts.pose.lat_deg - centre.lat) * kMetresADegree;
  const double east_m = (facts.pose.lon_deg - centre.lon) * kMetresADegree *
                        std::cos(centre.lat * std::numbers::pi / 180);
  const double distance_m = std::max(0.0, std::hypot(north_m, east_m) - kZoneRadiusM);
  out.emplace_back(
      model::SpatialDirectiveStatus{.directive_id = kZoneIds.at(zone),
                                    .last_eval_time_ms = moment.now_ms,
                                    .active = true,
                                    .inside_zone = distance_m <= 0,
                                    .distance_to_zone_m = static_cast<float>(distance_m)});
}

}  // namespace uplink::synthetic
