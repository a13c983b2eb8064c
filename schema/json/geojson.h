#pragma once

#include <boost/json.hpp>

#include "schema/model/spatial.h"

namespace uplink::json {

/// The geometry as GeoJSON (RFC 7946): `{"type":"Polygon","coordinates":[[[lon,lat],...]]}`.
/// Rings are closed; their direction is left as it was sent, which readers must accept.
[[nodiscard]] boost::json::object RenderGeometry(const model::ShapeData& data);

}  // namespace uplink::json
