#include "schema/rules/spatial.h"

#include "schema/limits.h"
#include "schema/rules/numbers.h"

namespace uplink::schema {
namespace {

constexpr Bounds kLatitude = {-kLatitudeDegMax, kLatitudeDegMax};
constexpr Bounds kLongitude = {-kLongitudeDegMax, kLongitudeDegMax};

}  // namespace

model::GeoPoint2 JudgePosition(Violations& violations, const Path& path,
                               const model::GeoPoint2& raw) {
  return {.lon = InRange(violations, path.Field("lon"), raw.lon, kLongitude).value_or(0),
          .lat = InRange(violations, path.Field("lat"), raw.lat, kLatitude).value_or(0)};
}

}  // namespace uplink::schema
