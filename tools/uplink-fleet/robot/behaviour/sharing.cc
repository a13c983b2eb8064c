#include "tools/uplink-fleet/robot/behaviour/sharing.h"

#include <fmt/core.h>

#include "tools/uplink-fleet/robot/behaviour/route.h"

namespace uplink::synthetic {
namespace {

constexpr std::int64_t kFlashMs = 2'000;
/// Of one that is reported again: it is still there then.
constexpr std::int64_t kLongFlashMs = 30'000;
constexpr std::int64_t kLongerFlashMs = 45'000;
constexpr double kDeletedShare = 0.2;
constexpr double kToldAgainShare = 0.3;

model::GeoPoint2 Near(const Facts& facts, Seeded& random) {
  return Offset({.lon = facts.pose.lon_deg, .lat = facts.pose.lat_deg}, random.Between(-10, 10),
                random.Between(-10, 10));
}

}  // namespace

model::ScopeType Sharing::NextScope() {
  using enum model::ScopeType;
  switch (random_.Below(6)) {
    case 0:
      return kRobot;
    case 1:
      return kUser;
    case 2:
      return kWorld;
    default:
      return kFleet;
  }
}

void Sharing::Advance(const Moment& moment, const Facts& facts, Outbox& out) {
  if (common_.Passed(moment.dt_s)) {
    Hazard(facts, out);
    Thing(moment, facts, out);
  }
  if (!flash_every_.Passed(moment.dt_s)) return;
  TellAgain(moment, out);
  Flash(moment, facts, out);
}

void Sharing::Hazard(const Facts& facts, Outbox& out) {
  const std::string id = run_ + "-common";
  if (hazard_ && random_.Chance(kDeletedShare)) {
    hazard_ = false;
    out.emplace_back(model::ShapeOp{model::Deletion{id}});
    return;
  }
  hazard_ = true;
  model::ReportedShape shape;
  shape.identity = {.id = id,
                    .name = "wet floor",
                    .rev = ++revision_,
                    .hash = fmt::format("{:016x}", random_.Next())};
  shape.area_type = model::ReportedLayerRole::kHazard;
  shape.data = Near(facts, random_);
  shape.scope = NextScope();
  out.emplace_back(model::ShapeOp{std::move(shape)});
}

void Sharing::Thing(const Moment& moment, const Facts& facts, Outbox& out) {
  const std::string id = run_ + "-common";
  if (thing_ && random_.Chance(kDeletedShare)) {
    thing_ = false;
    out.emplace_back(model::ObjectOp{model::Deletion{id}});
    return;
  }
  thing_ = true;
  const model::GeoPoint2 at = Near(facts, random_);
  model::Object object;
  object.id = id;
  object.name = "pallet";
  object.unix_time_ms = moment.now_ms;
  object.scope = NextScope();
  object.object_type = model::ObjectType::kObstacle;
  object.location = {.lat_deg = at.lat,
                     .lon_deg = at.lon,
                     .altitude_m = facts.pose.altitude_m,
                     .heading_deg = std::nullopt};
  object.radius_m = random_.Between(0.5, 1);
  out.emplace_back(model::ObjectOp{std::move(object)});
}

void Sharing::Flash(const Moment& moment, const Facts& facts, Outbox& out) {
  const bool again = random_.Chance(kToldAgainShare);
  model::ReportedShape shape;
  shape.identity = {.id = fmt::format("{}-flash-{}", mark_, ++flashes_),
                    .name = "someone crosses",
                    .rev = 1,
                    .hash = fmt::format("{:016x}", random_.Next())};
  shape.area_type = model::ReportedLayerRole::kOccupied;
  shape.data = Near(facts, random_);
  shape.scope = model::ScopeType::kFleet;
  shape.expire_time_ms = moment.now_ms + (again ? kLongFlashMs : kFlashMs);
  if (again) flash_ = shape;
  out.emplace_back(model::ShapeOp{std::move(shape)});
}

void Sharing::TellAgain(const Moment& moment, Outbox& out) {
  if (!flash_) return;
  model::ReportedShape shape = *std::exchange(flash_, std::nullopt);
  shape.expire_time_ms = moment.now_ms + kLongerFlashMs;
  out.emplace_back(model::ShapeOp{std::move(shape)});
}

}  // namespace uplink::synthetic
