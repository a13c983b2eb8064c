#include "schema/json/geojson.h"

#include <variant>

#include "schema/json/fields.h"

namespace uplink::json {
namespace {

using boost::json::array;
using boost::json::object;

array Coordinates(const model::GeoPoint2& point) { return {point.lon, point.lat}; }

array Coordinates(const model::Positions& positions) {
  return ListOf(positions, [](const model::GeoPoint2& point) { return Coordinates(point); });
}

array Ring(const model::Positions& positions) {
  array ring = Coordinates(positions);
  if (!positions.empty() && !(positions.front() == positions.back())) {
    ring.push_back(Coordinates(positions.front()));
  }
  return ring;
}

array Coordinates(const model::PolygonData& polygon) {
  array rings;
  rings.reserve(1 + polygon.holes.size());
  rings.push_back(Ring(polygon.exterior));
  for (const model::Positions& hole : polygon.holes) rings.push_back(Ring(hole));
  return rings;
}

object Geometry(std::string_view type, array coordinates) {
  return Fields().Set("type", std::string(type)).Set("coordinates", std::move(coordinates)).Take();
}

/// One overload an alternative.
struct Renderer {
  object operator()(const model::GeoPoint2& point) const {
    return Geometry("Point", Coordinates(point));
  }
  object operator()(const model::MultiPoint& data) const {
    return Geometry("MultiPoint", Coordinates(data.points));
  }
  object operator()(const model::LineString& data) const {
    return Geometry("LineString", Coordinates(data.points));
  }
  object operator()(const model::MultiLineString& data) const {
    return Geometry("MultiLineString", ListOf(data.lines, [](const model::Positions& line) {
                      return Coordinates(line);
                    }));
  }
  object operator()(const model::PolygonData& data) const {
    return Geometry("Polygon", Coordinates(data));
  }
  object operator()(const model::MultiPolygon& data) const {
    return Geometry("MultiPolygon", ListOf(data.polygons, [](const model::PolygonData& polygon) {
                      return Coordinates(polygon);
                    }));
  }
};

}  // namespace

object RenderGeometry(const model::ShapeData& data) { return std::visit(Renderer(), data); }

}  // namespace uplink::json
