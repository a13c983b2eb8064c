// Whether robots behave like robots: what they say of themselves fits together.
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

#include "tools/uplink-fleet/robot/behaviour/battery.h"
#include "tools/uplink-fleet/robot/behaviour/controls.h"
#include "tools/uplink-fleet/robot/behaviour/coverage.h"
#include "tools/uplink-fleet/robot/behaviour/equipment.h"
#include "tools/uplink-fleet/robot/behaviour/faults.h"
#include "tools/uplink-fleet/robot/behaviour/missions.h"
#include "tools/uplink-fleet/robot/behaviour/objects.h"
#include "tools/uplink-fleet/robot/behaviour/route.h"
#include "tools/uplink-fleet/robot/behaviour/settings.h"

namespace uplink::synthetic {
namespace {

constexpr std::int64_t kNowMs = 1'763'683'200'000;
constexpr double kTickS = 0.1;

/// Lives `seconds` in steps of a tenth.
void Live(double seconds, const std::function<void(const Moment&)>& step) {
  const int ticks = static_cast<int>(seconds / kTickS);
  for (int i = 1; i <= ticks; ++i) step({kNowMs + 100 * i, kTickS});
}

template <typename Body>
std::vector<Body> All(const Outbox& out) {
  std::vector<Body> all;
  for (const model::Body& body : out) {
    if (const auto* one = std::get_if<Body>(&body)) all.push_back(*one);
  }
  return all;
}

TEST(Seeded, GivesTheSameForTheSameSeedAndStaysInRange) {
  Seeded a(7);
  Seeded b(7);
  Seeded c(8);
  bool differs = false;
  for (int i = 0; i < 1000; ++i) {
    const std::uint64_t next = a.Next();
    EXPECT_EQ(next, b.Next());
    differs = differs || next != c.Next();
    const double unit = c.Unit();
    EXPECT_TRUE(unit >= 0 && unit < 1);
    EXPECT_LT(c.Below(3), 3U);
  }
  EXPECT_TRUE(differs);
}

TEST(Route, SpeedAndHeadingFitThePositions) {
  Route route(Seeded(3));
  Facts facts;
  std::optional<model::MotionTelemetry> before;
  double driven_m = 0;
  Live(300, [&](const Moment& moment) {
    route.Advance(moment, facts);
    const model::MotionTelemetry motion = route.Motion(moment, facts);
    if (before) {
      const double metres_a_degree = kMetresADegree;
      const double north_m = (motion.pose->lat_deg - before->pose->lat_deg) * metres_a_degree;
      const double east_m = (motion.pose->lon_deg - before->pose->lon_deg) * metres_a_degree *
                            std::cos(motion.pose->lat_deg * std::numbers::pi / 180);
      const double moved_m = std::hypot(north_m, east_m);
      driven_m += moved_m;
      EXPECT_NEAR(moved_m / kTickS, *motion.velocity->linear_mps, 0.01);
      if (moved_m > 0.01) {
        const double bearing = std::atan2(east_m, north_m) * 180 / std::numbers::pi;
        EXPECT_NEAR(std::remainder(*motion.pose->heading_deg - bearing, 360), 0, 0.5);
      }
      const double turned =
          std::remainder(*motion.pose->heading_deg - *before->pose->heading_deg, 360);
      EXPECT_NEAR(-turned * std::numbers::pi / 180 / kTickS, *motion.velocity->angular_rps, 0.01);
    }
    before = motion;
  });
  EXPECT_GT(driven_m, 100);
  EXPECT_NEAR(driven_m, facts.distance_m, 1);
}

TEST(Route, StandsStillWhileTheRobotMayNotDrive) {
  Route route(Seeded(3));
  Facts facts;
  Live(20, [&](const Moment& moment) { route.Advance(moment, facts); });
  EXPECT_GT(facts.speed_mps, 0.5);
  facts.estop = true;
  Live(5, [&](const Moment& moment) { route.Advance(moment, facts); });
  EXPECT_EQ(facts.speed_mps, 0);
}

TEST(Battery, DrainsThenChargesAndSaysSo) {
  Battery battery(Seeded(1));
  Facts facts;
  facts.speed_mps = 1;
  Outbox out;
  bool charged = false;
  double lowest = 100;
  double before = facts.soc_pct;
  Live(2000, [&](const Moment& moment) {
    const bool charging = facts.charging;
    battery.Advance(moment, facts, out);
    lowest = std::min(lowest, facts.soc_pct);
    if (charging) {
      EXPECT_GE(facts.soc_pct, before);
      charged = charged || !facts.charging;
    }
    before = facts.soc_pct;
    const model::BatteryStatus status = battery.Status(facts);
    EXPECT_EQ(*status.current_a > 0, charging);
    EXPECT_NEAR(*status.charge_ah / *status.capacity_ah * 100, *status.soc_pct, 0.01);
  });
  EXPECT_TRUE(charged);
  EXPECT_NEAR(lowest, 15, 0.2);
  EXPECT_GE(All<model::Message>(out).size(), 2U);
  EXPECT_GE(facts.charge_cycles, 1U);
}

TEST(Controls, EveryChangeIsAnEventAndTheStopIsReleasedAgain) {
  Controls controls(Seeded(5));
  Facts facts;
  Outbox out;
  Live(600, [&](const Moment& moment) {
    controls.Advance(moment, facts, out);
    EXPECT_EQ(controls.EStop().active, facts.estop);
    EXPECT_EQ(controls.EStop().ids.empty(), !facts.estop);
  });
  int engaged = 0;
  int released = 0;
  model::RobotMode mode = model::RobotMode::kAuto;
  for (const auto& event : All<model::EventTelemetry>(out)) {
    engaged += std::holds_alternative<model::EstopEngagedEvent>(event.kind) ? 1 : 0;
    released += std::holds_alternative<model::EstopReleasedEvent>(event.kind) ? 1 : 0;
    if (const auto* changed = std::get_if<model::ModeChangedEvent>(&event.kind)) {
      EXPECT_EQ(changed->from, mode);
      mode = changed->to;
    }
  }
  EXPECT_GT(engaged, 2);
  EXPECT_LE(engaged - released, 1);
  EXPECT_EQ(mode, facts.mode);
}

TEST(Missions, RunToTheirEndAndSometimesDoNot) {
  Missions missions(Seeded(2), "m");
  Route route(Seeded(3));
  Facts facts;
  Outbox out;
  Live(1800, [&](const Moment& moment) {
    facts.estop = moment.now_ms % 60'000 < 3'000;
    missions.Advance(moment, facts, route, out);
  });
  std::map<model::MissionStatus, int> ends;
  std::map<std::string, model::MissionStatus> last;
  std::map<std::string, int> progress;
  bool late = false;
  for (const auto& report : All<model::MissionRunStatus>(out)) {
    if (last.contains(report.run_id) && model::IsTerminal(last[report.run_id])) {
      late = true;
      EXPECT_EQ(report.status, last[report.run_id]);
    } else if (model::IsTerminal(report.status)) {
      ++ends[report.status];
      EXPECT_TRUE(report.time_completed_ms);
    }
    if (report.status != model::MissionStatus::kReady) {
      EXPECT_GE(*report.progress_x100, progress[report.run_id]);
    }
    progress[report.run_id] = *report.progress_x100;
    last[report.run_id] = report.status;
    if (report.status == model::MissionStatus::kComplete) {
      EXPECT_EQ(report.progress_x100, 10'000);
    }
  }
  EXPECT_EQ(last.size(), missions.runs());
  EXPECT_GT(ends[model::MissionStatus::kComplete], 30);
  EXPECT_GT(ends[model::MissionStatus::kError] + ends[model::MissionStatus::kAborted], 3);
  EXPECT_TRUE(late) << "a report after the end";
  EXPECT_GT(All<model::EventTelemetry>(out).size(), 50U);
}

TEST(Faults, EachChangeHasItsEvent) {
  Faults faults(Seeded(2), "m", "source", 2);
  Facts facts;
  Outbox out;
  std::set<std::string> active;
  std::set<std::string> descriptions;
  Live(300, [&](const Moment& moment) {
    Outbox now;
    faults.Advance(moment, facts, now);
    for (const auto& fault : All<model::Fault>(now)) {
      EXPECT_TRUE(descriptions.insert(fault.description).second);
      const bool change = active.contains(fault.fault_id) != fault.active;
      EXPECT_EQ(now.size(), change ? 2U : 1U);
      if (fault.active) {
        active.insert(fault.fault_id);
      } else {
        EXPECT_TRUE(change) << "only what is active is cleared";
        active.erase(fault.fault_id);
      }
    }
    EXPECT_EQ(facts.faulted, !active.empty());
    out.insert(out.end(), now.begin(), now.end());
  });
  EXPECT_GT(descriptions.size(), 300U);
}

TEST(Coverage, GrowsIsTakenBackAndUsesEveryGeometry) {
  Route route(Seeded(3));
  Missions missions(Seeded(4), "m");
  Coverage coverage(Seeded(5), "m");
  Facts facts;
  Outbox ignored;
  Outbox out;
  Live(600, [&](const Moment& moment) {
    route.Advance(moment, facts);
    missions.Advance(moment, facts, route, ignored);
    coverage.Advance(moment, facts, missions, route, out);
  });
  std::map<std::size_t, int> geometries;
  std::map<std::string, std::uint32_t> revisions;
  std::map<std::string, std::size_t> points;
  int deleted = 0;
  bool grown = false;
  for (const auto& op : All<model::ShapeOp>(out)) {
    const model::ReportedShape* shape = op.upsert();
    if (shape == nullptr) {
      ++deleted;
      continue;
    }
    ++geometries[shape->data.index()];
    EXPECT_GT(shape->identity.rev, revisions[op.id()]);
    revisions[op.id()] = shape->identity.rev;
    if (const auto* polygon = std::get_if<model::PolygonData>(&shape->data)) {
      grown = grown || (points[op.id()] > 0 && polygon->exterior.size() > points[op.id()]);
      points[op.id()] = polygon->exterior.size();
    }
    EXPECT_TRUE(shape->expire_time_ms == 0 || shape->expire_time_ms > kNowMs);
  }
  EXPECT_EQ(geometries.size(), std::variant_size_v<model::ShapeData>);
  EXPECT_TRUE(grown);
  EXPECT_GT(deleted, 2);
}

TEST(Objects, MoveExpireAndAreDeleted) {
  Objects objects(Seeded(6), "m");
  Facts facts;
  facts.pose = {.lat_deg = 47, .lon_deg = 8, .altitude_m = 400, .heading_deg = 0};
  Outbox out;
  Live(300, [&](const Moment& moment) { objects.Advance(moment, facts, out); });
  std::map<std::string, std::int64_t> expiries;
  std::map<std::string, model::Pose> places;
  std::set<std::string> deleted;
  bool moved = false;
  bool unending = false;
  for (const auto& op : All<model::ObjectOp>(out)) {
    if (op.deletion() != nullptr) {
      EXPECT_TRUE(expiries.contains(op.id()));
      deleted.insert(op.id());
      continue;
    }
    EXPECT_FALSE(deleted.contains(op.id()));
    const model::Object& object = *op.upsert();
    unending = unending || object.expires_unix_time_ms == 0;
    // Were it not so, one that came late could bring back what has expired.
    EXPECT_GE(object.expires_unix_time_ms, expiries[op.id()]);
    expiries[op.id()] = object.expires_unix_time_ms;
    moved = moved || (places.contains(op.id()) && places[op.id()] != object.location);
    places[op.id()] = object.location;
  }
  EXPECT_TRUE(moved);
  EXPECT_TRUE(unending);
  EXPECT_GT(deleted.size(), 3U);
  EXPECT_GT(expiries.size(), deleted.size() + 3) << "the others expire";
}

TEST(Settings, ChangeWithinWhatTheCapabilitiesDeclare) {
  Settings settings(Seeded(7));
  Outbox out;
  Live(900, [&](const Moment& moment) { settings.Advance(moment, out); });
  const auto capabilities = All<model::UiCapabilities>(out);
  ASSERT_EQ(capabilities.size(), 1U);
  const auto told = All<model::CurrentSettings>(out);
  EXPECT_GT(told.size(), 40U);
  std::set<std::string> changed;
  for (const model::CurrentSettings& each : told) {
    ASSERT_EQ(each.settings.size(), capabilities[0].settings.size());
    for (std::size_t i = 0; i < each.settings.size(); ++i) {
      const model::SettingDescriptor& of = capabilities[0].settings[i];
      const model::Value& value = each.settings[i].value;
      EXPECT_EQ(each.settings[i].key, of.key);
      EXPECT_EQ(model::TypeOf(value), of.value_type);
      if (value != of.default_value) changed.insert(of.key);
      if (const auto* number = std::get_if<double>(&value)) {
        EXPECT_TRUE(*number >= of.range->min && *number <= of.range->max);
      }
    }
  }
  EXPECT_EQ(changed.size(), capabilities[0].settings.size());
}

TEST(Equipment, CountsGrowAndTanksEmptyAndAreFilled) {
  Equipment equipment(Seeded(8));
  Route route(Seeded(3));
  Facts facts;
  facts.mission_active = true;
  Outbox out;
  Live(900, [&](const Moment& moment) {
    route.Advance(moment, facts);
    equipment.Advance(moment, facts, route, out);
  });
  double distance_m = 0;
  for (const auto& usage : All<model::UsageTelemetry>(out)) {
    EXPECT_GE(*usage.total_distance_m, distance_m);
    distance_m = *usage.total_distance_m;
  }
  bool critical = false;
  std::map<std::string, float> levels;
  bool filled = false;
  for (const auto& tank : All<model::ConsumableStatus>(out)) {
    critical = critical || tank.is_critical;
    filled = filled || (levels.contains(tank.tank_id) && *tank.level_pct > levels[tank.tank_id]);
    levels[tank.tank_id] = *tank.level_pct;
  }
  EXPECT_TRUE(critical);
  EXPECT_TRUE(filled);
  EXPECT_EQ(levels.size(), 2U);
  bool inside = false;
  bool outside = false;
  for (const auto& zone : All<model::SpatialDirectiveStatus>(out)) {
    EXPECT_EQ(zone.inside_zone, *zone.distance_to_zone_m == 0);
    inside = inside || zone.inside_zone;
    outside = outside || !zone.inside_zone;
  }
  EXPECT_TRUE(inside && outside);
  EXPECT_GT(All<model::AgentInfo>(out).size(), 10U);
}

}  // namespace
}  // namespace uplink::synthetic
