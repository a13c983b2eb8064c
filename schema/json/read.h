#pragma once

#include <string_view>

#include <absl/status/statusor.h>

#include "schema/model/motion.h"
#include "schema/model/spatial.h"

/// Texts that a store keeps, as the model again: what json/text.h wrote comes back equal, to the
/// last bit of a number. Errors: kDataLoss, in words, for a text that text.h does not write. Pure;
/// any thread.
namespace uplink::json {

/// The inverse of GeometryText: a ring that was sent open is open again.
[[nodiscard]] absl::StatusOr<model::ShapeData> ReadGeometry(std::string_view geojson);
[[nodiscard]] absl::StatusOr<model::Pose> ReadPose(std::string_view text);
[[nodiscard]] absl::StatusOr<model::Trajectory> ReadTrajectory(std::string_view text);

}  // namespace uplink::json
