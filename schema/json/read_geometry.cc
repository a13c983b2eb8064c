#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <absl/status/status.h>

#include "schema/json/exact.h"
#include "schema/json/geojson.h"
#include "schema/json/read.h"

namespace uplink::json {
namespace {

using boost::json::array;
using boost::json::value;

/// Reads one geometry. A member that is not as it must be makes it bad, and what is read is then of
/// no use.
class GeometryReader final {
 public:
  /// `open_rings` are the numbers of the rings that were sent open, in ascending order.
  explicit GeometryReader(std::vector<std::size_t> open_rings)
      : open_rings_(std::move(open_rings)) {}

  [[nodiscard]] model::ShapeData Read(std::string_view type, const value& coordinates) {
    if (type == "Point") return Position(coordinates);
    if (type == "MultiPoint") return model::MultiPoint{Positions(coordinates)};
    if (type == "LineString") return model::LineString{Positions(coordinates)};
    if (type == "MultiLineString") {
      model::MultiLineString lines;
      for (const value& line : Items(coordinates)) lines.lines.push_back(Positions(line));
      return lines;
    }
    if (type == "Polygon") return Polygon(coordinates);
    if (type == "MultiPolygon") {
      model::MultiPolygon polygons;
      for (const value& polygon : Items(coordinates)) {
        polygons.polygons.push_back(Polygon(polygon));
      }
      return polygons;
    }
    good_ = false;
    return {};
  }

  /// True if all was as GeometryText writes it, down to the last open ring.
  [[nodiscard]] bool good() const { return good_ && next_open_ == open_rings_.size(); }

 private:
  const array& Items(const value& list) {
    if (list.is_array()) return list.get_array();
    good_ = false;
    return none_;
  }
  model::GeoPoint2 Position(const value& position) {
    const array& items = Items(position);
    const auto lon = items.size() == 2 ? NumberOf(items[0]) : std::nullopt;
    const auto lat = items.size() == 2 ? NumberOf(items[1]) : std::nullopt;
    if (!lon || !lat) good_ = false;
    return {.lon = lon.value_or(0), .lat = lat.value_or(0)};
  }
  model::Positions Positions(const value& list) {
    const array& items = Items(list);
    model::Positions positions;
    positions.reserve(items.size());
    for (const value& item : items) positions.push_back(Position(item));
    return positions;
  }
  model::Positions Ring(const value& list) {
    model::Positions ring = Positions(list);
    const std::size_t index = rings_++;
    if (next_open_ == open_rings_.size() || open_rings_[next_open_] != index) return ring;
    ++next_open_;
    // Only two different positions make a ring open.
    if (ring.size() < 3 || !(ring.front() == ring.back())) {
      good_ = false;
      return ring;
    }
    ring.pop_back();
    return ring;
  }
  model::PolygonData Polygon(const value& list) {
    const array& rings = Items(list);
    if (rings.empty()) {
      good_ = false;
      return {};
    }
    model::PolygonData polygon{.exterior = Ring(rings.front()), .holes = {}};
    polygon.holes.reserve(rings.size() - 1);
    for (std::size_t i = 1; i < rings.size(); ++i) polygon.holes.push_back(Ring(rings[i]));
    return polygon;
  }

  const std::vector<std::size_t> open_rings_;
  const array none_;
  std::size_t next_open_ = 0;
  std::size_t rings_ = 0;
  bool good_ = true;
};

/// The numbers under kOpenRings; empty if there are none, nothing if they are no such list.
std::optional<std::vector<std::size_t>> OpenRings(const boost::json::object& geometry) {
  std::vector<std::size_t> rings;
  const value* const listed = geometry.if_contains(kOpenRings);
  if (listed == nullptr) return rings;
  if (!listed->is_array()) return std::nullopt;
  for (const value& item : listed->get_array()) {
    const auto* const ring = item.if_int64();
    if (ring == nullptr || *ring < 0) return std::nullopt;
    rings.push_back(static_cast<std::size_t>(*ring));
  }
  return rings;
}

std::optional<model::ShapeData> GeometryIn(std::string_view geojson) {
  const std::optional<value> body = ParseExact(geojson);
  if (!body || !body->is_object()) return std::nullopt;
  const boost::json::object& geometry = body->get_object();
  const value* const type = geometry.if_contains("type");
  const value* const coordinates = geometry.if_contains("coordinates");
  if (type == nullptr || !type->is_string() || coordinates == nullptr) return std::nullopt;
  std::optional<std::vector<std::size_t>> open_rings = OpenRings(geometry);
  if (!open_rings) return std::nullopt;
  GeometryReader reader(*std::move(open_rings));
  const boost::json::string& name = type->get_string();
  model::ShapeData data = reader.Read({name.data(), name.size()}, *coordinates);
  if (!reader.good()) return std::nullopt;
  return data;
}

}  // namespace

absl::StatusOr<model::ShapeData> ReadGeometry(std::string_view geojson) {
  std::optional<model::ShapeData> data = GeometryIn(geojson);
  if (!data) return absl::DataLossError("the text is no geometry of a store");
  return *std::move(data);
}

}  // namespace uplink::json
