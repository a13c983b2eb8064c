#include <variant>

#include "schema/json/fields.h"
#include "schema/json/render.h"

namespace uplink::json {
namespace {

using boost::json::array;
using boost::json::object;

object RenderPoint(const model::GeoPoint2& point) {
  return Fields().Set("lon", point.lon).Set("lat", point.lat).Take();
}

array RenderPositions(const model::Positions& positions) { return ListOf(positions, RenderPoint); }

object RenderPolygon(const model::PolygonData& polygon) {
  return Fields()
      .Set("exterior", RenderPositions(polygon.exterior))
      .Set("holes", ListOf(polygon.holes, RenderPositions))
      .Take();
}

/// One geometry under its member's name; one overload an alternative.
struct GeometryRenderer {
  object operator()(const model::GeoPoint2& point) const {
    return Fields().Set("point", RenderPoint(point)).Take();
  }
  object operator()(const model::MultiPoint& data) const {
    return Fields().Set("multiPoint", RenderPositions(data.points)).Take();
  }
  object operator()(const model::LineString& data) const {
    return Fields().Set("lineString", RenderPositions(data.points)).Take();
  }
  object operator()(const model::MultiLineString& data) const {
    return Fields().Set("multiLineString", ListOf(data.lines, RenderPositions)).Take();
  }
  object operator()(const model::PolygonData& data) const {
    return Fields().Set("polygon", RenderPolygon(data)).Take();
  }
  object operator()(const model::MultiPolygon& data) const {
    return Fields().Set("multiPolygon", ListOf(data.polygons, RenderPolygon)).Take();
  }
};

object RenderUpsert(const model::ReportedShape& shape) {
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

object RenderUpsert(const model::Object& body) {
  Fields fields;
  fields.Set("id", body.id)
      .Set("name", body.name)
      .Set("unixTimeMs", body.unix_time_ms)
      .Set("expiresUnixTimeMs", body.expires_unix_time_ms)
      .Set("scope", body.scope)
      .Set("objectType", body.object_type)
      .Set("location", Render(body.location))
      .Set("radiusM", body.radius_m);
  if (body.trajectory) fields.Set("trajectory", Render(*body.trajectory));
  return fields.Take();
}

template <typename Op>
object RenderOp(const Op& op) {
  if (op.upsert() != nullptr) return Fields().Set("upsert", RenderUpsert(*op.upsert())).Take();
  return Fields().Set("delete", op.id()).Take();
}

}  // namespace

object Render(const model::Trajectory& trajectory) {
  return Fields()
      .Set("speedMps", trajectory.speed_mps)
      .Set("courseDeg", trajectory.course_deg)
      .Set("verticalRateMps", trajectory.vertical_rate_mps)
      .Take();
}

object Render(const model::ShapeOp& body) { return RenderOp(body); }

object Render(const model::ObjectOp& body) { return RenderOp(body); }

}  // namespace uplink::json
