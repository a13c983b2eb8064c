#include "schema/cyberwave/families.h"

namespace uplink::cyberwave {

using model::cyberwave::Position;
using model::cyberwave::Rotation;
using model::cyberwave::Scale;
using schema::Path;

Position ReadPosition(Reader& in) {
  constexpr schema::Bounds kBounds = {.min = -kPositionMMax, .max = kPositionMMax};
  const boost::json::object* object = in.Object("position", Need::kMust);
  if (object == nullptr) return {};
  const Path path = in.path().Field("position");
  Reader axes(*object, path, in.violations());
  return {.x_m = axes.NumberIn("x", kBounds, Need::kMust).value_or(0),
          .y_m = axes.NumberIn("y", kBounds, Need::kMust).value_or(0),
          .z_m = axes.NumberIn("z", kBounds, Need::kMust).value_or(0)};
}

Rotation ReadRotation(Reader& in) {
  const boost::json::object* object = in.Object("rotation", Need::kMust);
  if (object == nullptr) return {};
  const Path path = in.path().Field("rotation");
  Reader parts(*object, path, in.violations());
  bool any = false;
  // One that is there must be good: another value in its place would be another rotation.
  const auto part = [&parts, &any](std::string_view name, double otherwise) {
    if (parts.Find(name) == nullptr) return otherwise;
    any = true;
    return parts.Number(name, Need::kMust).value_or(otherwise);
  };
  Rotation rotation = {.w = part("w", 1), .x = part("x", 0), .y = part("y", 0), .z = part("z", 0)};
  if (!any) in.Missing("rotation", Need::kMust, "has none of w, x, y and z");
  const bool zero = rotation.w == 0 && rotation.x == 0 && rotation.y == 0 && rotation.z == 0;
  return zero ? Rotation() : rotation;
}

Scale ReadScale(Reader& in) {
  const boost::json::object* object = in.Object("scale", Need::kMust);
  if (object == nullptr) return {};
  const Path path = in.path().Field("scale");
  Reader axes(*object, path, in.violations());
  return {.x = axes.Number("x", Need::kMust).value_or(1),
          .y = axes.Number("y", Need::kMust).value_or(1),
          .z = axes.Number("z", Need::kMust).value_or(1)};
}

}  // namespace uplink::cyberwave
