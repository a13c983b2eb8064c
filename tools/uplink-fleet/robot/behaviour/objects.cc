#include "tools/uplink-fleet/robot/behaviour/objects.h"

#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/core.h>

#include "tools/uplink-fleet/robot/behaviour/route.h"

namespace uplink::synthetic {
namespace {

using enum model::ObjectType;

constexpr std::int64_t kLifeMs = 10'000;
constexpr double kSharedShare = 0.1;
constexpr std::array<std::pair<model::ObjectType, const char*>, 5> kKinds = {{{kPerson, "person"},
                                                                              {kAnimal, "dog"},
                                                                              {kVehicle, "car"},
                                                                              {kDebris, "branch"},
                                                                              {kUnknown, ""}}};

}  // namespace

void Objects::Begin(Seen& seen, const Moment& moment, const Facts& facts) {
  const auto& [type, name] = kKinds.at(random_.Below(kKinds.size()));
  const model::GeoPoint2 at = Offset({.lon = facts.pose.lon_deg, .lat = facts.pose.lat_deg},
                                     random_.Between(-20, 20), random_.Between(-20, 20));
  model::Object object;
  object.id = fmt::format("{}-object-{}", mark_, ++objects_);
  object.name = name;
  object.unix_time_ms = moment.now_ms;
  // What moves is told again and again, and each time to every robot of the fleet.
  object.scope = random_.Chance(kSharedShare) ? model::ScopeType::kFleet : model::ScopeType::kRobot;
  object.object_type = type;
  object.location = {.lat_deg = at.lat,
                     .lon_deg = at.lon,
                     .altitude_m = facts.pose.altitude_m,
                     .heading_deg = std::nullopt};
  if (type != kDebris) {
    object.trajectory = model::Trajectory{.speed_mps = random_.Between(0.3, 3),
                                          .course_deg = random_.Between(0, 359),
                                          .vertical_rate_mps = 0};
  }
  object.radius_m = random_.Between(0.2, 1.5);
  seen = {.object = std::move(object), .left_s = random_.Between(6, 25), .report = {2, 0}};
}

void Objects::Marker(const Moment& moment, const Facts& facts, Outbox& out) {
  model::Object marker;
  marker.id = mark_ + "-marker";
  marker.name = "base";
  marker.unix_time_ms = moment.now_ms;
  marker.scope = model::ScopeType::kWorld;
  marker.object_type = kMarker;
  marker.location = facts.pose;
  out.emplace_back(model::ObjectOp{std::move(marker)});
}

void Objects::Advance(const Moment& moment, const Facts& facts, Outbox& out) {
  if (!std::exchange(marked_, true)) Marker(moment, facts, out);
  for (Seen& seen : seen_) {
    seen.left_s -= moment.dt_s;
    if (seen.left_s <= 0) {
      if (!seen.object.id.empty() && random_.Chance(0.5)) {
        out.emplace_back(model::ObjectOp{model::Deletion{seen.object.id}});
      }
      Begin(seen, moment, facts);
    }
    if (const auto& trajectory = seen.object.trajectory) {
      const double course = trajectory->course_deg * std::numbers::pi / 180;
      const double step_m = trajectory->speed_mps * moment.dt_s;
      const model::GeoPoint2 at =
          Offset({.lon = seen.object.location.lon_deg, .lat = seen.object.location.lat_deg},
                 step_m * std::sin(course), step_m * std::cos(course));
      seen.object.location.lat_deg = at.lat;
      seen.object.location.lon_deg = at.lon;
    }
    if (!seen.report.Passed(moment.dt_s)) continue;
    seen.object.unix_time_ms = moment.now_ms;
    seen.object.expires_unix_time_ms = moment.now_ms + kLifeMs;
    out.emplace_back(model::ObjectOp{seen.object});
  }
}

}  // namespace uplink::synthetic
