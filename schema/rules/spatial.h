#pragma once

#include "schema/model/spatial.h"
#include "schema/rules/path.h"
#include "schema/rules/violations.h"

namespace uplink::schema {

/// A position of a shape (a durable kind); its latitude and longitude as in a pose.
[[nodiscard]] model::GeoPoint2 JudgePosition(Violations& violations, const Path& path,
                                             const model::GeoPoint2& raw);

}  // namespace uplink::schema
