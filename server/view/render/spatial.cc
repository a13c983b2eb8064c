#include <variant>

#include "server/view/render/fields.h"
#include "server/view/render/render.h"

namespace uplink::view {
namespace {

using google::protobuf::ListValue;
using google::protobuf::Struct;

Struct RenderPoint(const model::GeoPoint2& point) {
  return Fields().Set("lon", point.lon).Set("lat", point.lat).Take();
}

ListValue RenderPositions(const model::Positions& positions) {
  return ListOf(positions, RenderPoint);
}

Struct RenderPolygon(const model::PolygonData& polygon) {
  return Fields()
      .Set("exterior", RenderPositions(polygon.exterior))
      .Set("holes", ListOf(polygon.holes, RenderPositions))
      .Take();
}

/// One geometry under its member's name; one overload an alternative.
struct GeometryRenderer {
  Struct operator()(const model::GeoPoint2& point) const {
    return Fields().Set("point", RenderPoint(point)).Take();
  }
  Struct operator()(const model::MultiPoint& data) const {
    return Fields().Set("multiPoint", RenderPositions(data.points)).Take();
  }
  Struct operator()(const model::LineString& data) const {
    return Fields().Set("lineString", RenderPositions(data.points)).Take();
  }
  Struct operator()(const model::MultiLineString& data) const {
    return Fields().Set("multiLineString", ListOf(data.lines, RenderPositions)).Take();
  }
  Struct operator()(const model::PolygonData& data) const {
    return Fields().Set("polygon", RenderPolygon(data)).Take();
  }
  Struct operator()(const model::MultiPolygon& data) const {
    return Fields().Set("multiPolygon", ListOf(data.polygons, RenderPolygon)).Take();
  }
};

Struct RenderUpsert(const model::ReportedShape& shape) {
  return Fields()
      .Set("identity", Fields()
                           .Set("id", shape.identity.id)
                           .Set("name", shape.identity.name)
                           .Set("rev", shape.identity.rev)
                           .Set("hash", shape.identity.hash)
                           .Take())
      .Set("data", std::visit(GeometryRenderer(), shape.data))
      .Set("areaType", shape.area_type)
      .Set("scope", shape.scope)
      .Set("expireTimeMs", shape.expire_time_ms)
      .Set("minZM", shape.min_z_m)
      .Set("maxZM", shape.max_z_m)
      .Set("levelId", shape.level_id)
      .Take();
}

Struct RenderUpsert(const model::Object& object) {
  Fields fields;
  fields.Set("id", object.id)
      .Set("name", object.name)
      .Set("unixTimeMs", object.unix_time_ms)
      .Set("expiresUnixTimeMs", object.expires_unix_time_ms)
      .Set("scope", object.scope)
      .Set("objectType", object.object_type)
      .Set("location", Render(object.location))
      .Set("radiusM", object.radius_m);
  if (object.trajectory) fields.Set("trajectory", Render(*object.trajectory));
  return fields.Take();
}

template <typename Op>
Struct RenderOp(const Op& op) {
  if (op.upsert() != nullptr) return Fields().Set("upsert", RenderUpsert(*op.upsert())).Take();
  return Fields().Set("delete", op.id()).Take();
}

}  // namespace

Struct Render(const model::Trajectory& trajectory) {
  return Fields()
      .Set("speedMps", trajectory.speed_mps)
      .Set("courseDeg", trajectory.course_deg)
      .Set("verticalRateMps", trajectory.vertical_rate_mps)
      .Take();
}

Struct Render(const model::ShapeOp& body) { return RenderOp(body); }

Struct Render(const model::ObjectOp& body) { return RenderOp(body); }

}  // namespace uplink::view
