#include "tools/uplink-fleet/robot/behaviour/coverage.h"

#include <cmath>
#include <utility>

#include <fmt/core.h>

namespace uplink::synthetic {
namespace {

using Role = model::ReportedLayerRole;

/// Half the width of what a robot covers.
constexpr double kHalfWidthM = 0.6;
constexpr double kTrackStepM = 2;
/// Points of a track at most: 50 m; the oldest go.
constexpr std::size_t kTrackMax = 25;
constexpr std::size_t kCoveragesKept = 2;
constexpr std::int64_t kHazardLifeMs = 8'000;
constexpr std::int64_t kPlanLifeMs = 60'000;

/// The area on both sides of a track, as an open ring: along it and back.
model::PolygonData Strip(const model::Positions& track) {
  model::PolygonData polygon;
  model::Positions back;
  for (std::size_t i = 0; i < track.size(); ++i) {
    const model::GeoPoint2& from = track[i == 0 ? 0 : i - 1];
    const model::GeoPoint2& to = track[i == 0 ? 1 : i];
    const double along = std::atan2(to.lon - from.lon, to.lat - from.lat);
    const double east_m = kHalfWidthM * std::cos(along);
    const double north_m = -kHalfWidthM * std::sin(along);
    polygon.exterior.push_back(Offset(track[i], -east_m, -north_m));
    back.insert(back.begin(), Offset(track[i], east_m, north_m));
  }
  polygon.exterior.insert(polygon.exterior.end(), back.begin(), back.end());
  return polygon;
}

model::Positions Square(const model::GeoPoint2& centre, double half_m) {
  return {Offset(centre, -half_m, -half_m), Offset(centre, half_m, -half_m),
          Offset(centre, half_m, half_m), Offset(centre, -half_m, half_m)};
}

model::MultiPolygon Blocked(const model::GeoPoint2& origin) {
  return {.polygons = {{.exterior = Square(origin, 4), .holes = {Square(origin, 1)}},
                       {.exterior = Square(Offset(origin, 20, 5), 2), .holes = {}}}};
}

}  // namespace

model::ReportedShape Coverage::Shape(std::string id, std::string name, Role role,
                                     model::ShapeData data) {
  model::ReportedShape shape;
  shape.identity = {.id = fmt::format("{}-{}", mark_, id),
                    .name = std::move(name),
                    .rev = ++revision_,
                    .hash = fmt::format("{:016x}", random_.Next())};
  shape.area_type = role;
  shape.data = std::move(data);
  return shape;
}

void Coverage::Advance(const Moment& moment, const Facts& facts, const Missions& missions,
                       const Route& route, Outbox& out) {
  if (missions.runs() != run_) {
    run_ = missions.runs();
    BeginMission(moment, route, out);
  }
  if (facts.mission_active) Follow(facts);
  if (covered_.Passed(moment.dt_s)) Covered(moment, out);
  if (hazard_.Passed(moment.dt_s)) Hazard(moment, facts, out);
  if (fixed_.Passed(moment.dt_s)) Fixed(moment, route, out);
}

void Coverage::Follow(const Facts& facts) {
  const model::GeoPoint2 at{.lon = facts.pose.lon_deg, .lat = facts.pose.lat_deg};
  const double moved_m = kMetresADegree * std::hypot(at.lat - last_.lat, at.lon - last_.lon);
  if (!track_.empty() && moved_m < kTrackStepM) return;
  if (track_.size() == kTrackMax) track_.erase(track_.begin());
  track_.push_back(at);
  last_ = at;
  grown_ = true;
}

void Coverage::Covered(const Moment& /*moment*/, Outbox& out) {
  if (!std::exchange(grown_, false) || track_.size() < 2) return;
  model::ReportedShape shape =
      Shape(fmt::format("covered-{}", run_), "covered", Role::kCoverage, Strip(track_));
  shape.max_z_m = 0.4;
  out.emplace_back(model::ShapeOp{std::move(shape)});
}

void Coverage::BeginMission(const Moment& moment, const Route& route, Outbox& out) {
  track_.clear();
  kept_.push_back(fmt::format("{}-covered-{}", mark_, run_));
  if (kept_.size() > kCoveragesKept) {
    out.emplace_back(model::ShapeOp{model::Deletion{kept_.front()}});
    kept_.pop_front();
  }
  model::ReportedShape plan =
      Shape("plan", "planned path", Role::kPlannedPath, model::LineString{route.Ahead()});
  plan.expire_time_ms = moment.now_ms + kPlanLifeMs;
  out.emplace_back(model::ShapeOp{std::move(plan)});
}

void Coverage::Hazard(const Moment& moment, const Facts& facts, Outbox& out) {
  model::ReportedShape hazard =
      Shape(fmt::format("hazard-{}", ++hazards_), "hole in the ground", Role::kHazard,
            model::GeoPoint2{.lon = facts.pose.lon_deg, .lat = facts.pose.lat_deg});
  hazard.scope = model::ScopeType::kFleet;
  hazard.expire_time_ms = moment.now_ms + kHazardLifeMs;
  out.emplace_back(model::ShapeOp{std::move(hazard)});
}

void Coverage::Fixed(const Moment& /*moment*/, const Route& route, Outbox& out) {
  const model::GeoPoint2& origin = route.origin();
  switch (random_.Below(3)) {
    case 0:
      out.emplace_back(model::ShapeOp{Shape(
          "markers", "markers", Role::kConsumed,
          model::MultiPoint{{Offset(origin, random_.Between(1, 5), 2), Offset(origin, 8, 8)}})});
      break;
    case 1:
      out.emplace_back(model::ShapeOp{
          Shape("lanes", "lanes", Role::kReserved,
                model::MultiLineString{{{origin, Offset(origin, random_.Between(5, 20), 0)},
                                        {Offset(origin, 0, 3), Offset(origin, 10, 3)}}})});
      break;
    default: {
      model::ReportedShape blocked = Shape("blocked", "keep out", Role::kBlocked, Blocked(origin));
      blocked.scope = model::ScopeType::kWorld;
      blocked.min_z_m = -1;
      blocked.max_z_m = 2.5;
      blocked.level_id = static_cast<std::int32_t>(random_.Below(3)) - 1;
      out.emplace_back(model::ShapeOp{std::move(blocked)});
      break;
    }
  }
}

}  // namespace uplink::synthetic
