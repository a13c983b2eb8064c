#include "schema/json/geojson.h"

#include <cstdint>
#include <utility>
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

/// Closes the rings of one geometry and remembers which ones it had to close.
class Rings final {
 public:
  [[nodiscard]] array Coordinates(const model::PolygonData& polygon) {
    array rings;
    rings.reserve(1 + polygon.holes.size());
    rings.push_back(Ring(polygon.exterior));
    for (const model::Positions& hole : polygon.holes) rings.push_back(Ring(hole));
    return rings;
  }
  [[nodiscard]] array TakeOpen() { return std::move(open_); }

 private:
  array Ring(const model::Positions& positions) {
    array ring = json::Coordinates(positions);
    if (!positions.empty() && !(positions.front() == positions.back())) {
      ring.push_back(json::Coordinates(positions.front()));
      open_.push_back(count_);
    }
    ++count_;
    return ring;
  }

  std::int64_t count_ = 0;
  array open_;
};

object Geometry(std::string_view type, array coordinates) {
  return Fields().Set("type", std::string(type)).Set("coordinates", std::move(coordinates)).Take();
}

object RingGeometry(std::string_view type, array coordinates, array open) {
  object geometry = Geometry(type, std::move(coordinates));
  if (!open.empty()) geometry[kOpenRings] = std::move(open);
  return geometry;
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
    Rings rings;
    array coordinates = rings.Coordinates(data);
    return RingGeometry("Polygon", std::move(coordinates), rings.TakeOpen());
  }
  object operator()(const model::MultiPolygon& data) const {
    Rings rings;
    array coordinates = ListOf(data.polygons, [&](const model::PolygonData& polygon) {
      return rings.Coordinates(polygon);
    });
    return RingGeometry("MultiPolygon", std::move(coordinates), rings.TakeOpen());
  }
};

}  // namespace

object RenderGeometry(const model::ShapeData& data) { return std::visit(Renderer(), data); }

}  // namespace uplink::json
