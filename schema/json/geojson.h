#pragma once

#include <boost/json.hpp>

#include "schema/model/spatial.h"

namespace uplink::json {

/// A foreign member (RFC 7946, 6.1) of polygons: which rings were sent open, by their number in
/// order, exteriors before their holes, from 0. Absent if every ring was sent closed.
inline constexpr boost::json::string_view kOpenRings = "openRings";

/// The geometry as GeoJSON (RFC 7946): `{"type":"Polygon","coordinates":[[[lon,lat],...]]}`.
/// Rings are closed, and kOpenRings names those that were not; their direction is left as it was
/// sent, which readers must accept.
[[nodiscard]] boost::json::object RenderGeometry(const model::ShapeData& data);

}  // namespace uplink::json
