#include "tests/simulation/payloads.h"

#include "schema/encode.h"

namespace uplink::simulation {
namespace {

/// When a run begins.
constexpr std::int64_t kBeginsMs = 1'763'683'200'000;
/// Within a run of a few seconds, and after many of them.
constexpr std::int64_t kExpiresMs = kBeginsMs + 1'500;
constexpr std::int64_t kExpiresLaterMs = kBeginsMs + 5'000;

model::Fault FaultOf(std::string id) {
  model::Fault fault;
  fault.unix_time_ms = kBeginsMs;
  fault.fault_id = std::move(id);
  fault.source = "sim";
  fault.active = true;
  return fault;
}

model::ScopeType ScopeOf(Spatial spatial) {
  switch (spatial) {
    case Spatial::kForUser:
      return model::ScopeType::kUser;
    case Spatial::kForFleet:
    case Spatial::kForFleetMoved:
    case Spatial::kForFleetExpiring:
      return model::ScopeType::kFleet;
    case Spatial::kForWorld:
    case Spatial::kForWorldExpiring:
      return model::ScopeType::kWorld;
    default:
      return model::ScopeType::kRobot;
  }
}

std::int64_t ExpiryOf(Spatial spatial) {
  if (spatial == Spatial::kForFleetExpiring) return kExpiresMs;
  return spatial == Spatial::kForWorldExpiring ? kExpiresLaterMs : 0;
}

double LongitudeOf(Spatial spatial) { return spatial == Spatial::kForFleetMoved ? 8.5 : 8.25; }

model::ShapeOp ShapeOf(const std::string& id, Spatial spatial) {
  if (spatial == Spatial::kDeleted) return {model::Deletion{id}};
  model::ReportedShape shape;
  shape.identity = {.id = id, .name = "shape " + id};
  shape.data = model::GeoPoint2{.lon = LongitudeOf(spatial), .lat = 47.5};
  shape.area_type = model::ReportedLayerRole::kHazard;
  shape.scope = ScopeOf(spatial);
  shape.expire_time_ms = ExpiryOf(spatial);
  return {shape};
}

model::ObjectOp ObjectOf(const std::string& id, Spatial spatial) {
  if (spatial == Spatial::kDeleted) return {model::Deletion{id}};
  model::Object object;
  object.id = id;
  object.name = "object " + id;
  object.unix_time_ms = kBeginsMs;
  object.expires_unix_time_ms = ExpiryOf(spatial);
  object.scope = ScopeOf(spatial);
  object.object_type = model::ObjectType::kPerson;
  object.location = {.lat_deg = 47.5, .lon_deg = LongitudeOf(spatial)};
  return {object};
}

}  // namespace

void Payloads::SetSpatials() {
  for (std::size_t item = 0; item < kSpatialItems; ++item) {
    const std::string id = std::to_string(item / 2);
    for (std::size_t kind = 0; kind < kSpatialKinds; ++kind) {
      const auto spatial = static_cast<Spatial>(kind);
      bytes_[static_cast<std::size_t>(SpatialOf(item, spatial))] =
          item % 2 == 0 ? schema::Encode(ShapeOf(id, spatial))
                        : schema::Encode(ObjectOf(id, spatial));
    }
  }
}

Payloads::Payloads() {
  const auto set = [this](Content content, std::string bytes) {
    bytes_[static_cast<std::size_t>(content)] = std::move(bytes);
  };
  model::EventTelemetry event;
  event.unix_time_ms = kBeginsMs;
  model::MotionTelemetry motion;
  motion.unix_time_ms = kBeginsMs;
  set(Content::kFault, schema::Encode(FaultOf("BATTERY_LOW")));
  set(Content::kEvent, schema::Encode(event));
  set(Content::kMotion, schema::Encode(motion));
  set(Content::kBadDurable, schema::Encode(FaultOf("")));
  set(Content::kBadLive, schema::Encode(motion).substr(0, 20));
  model::Fault large = FaultOf("LARGE");
  large.description = std::string(1500, 'x');
  set(Content::kLarge, schema::Encode(large));
  set(Content::kRefused, schema::Encode(FaultOf(kRefusedFaultId)));
  SetSpatials();
}

}  // namespace uplink::simulation
