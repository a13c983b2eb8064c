#pragma once

#include <optional>

#include "schema/model/motion.h"
#include "schema/rules/path.h"
#include "schema/rules/violations.h"

namespace uplink::schema {

/// A pose as it stands in a message. Degrees and metres; NaN altitude or heading: not known.
struct RawPose {
  double lat_deg;
  double lon_deg;
  double altitude_m;
  double heading_deg;
};

/// A heading in degrees, any finite number, as the same direction in [0, 360).
[[nodiscard]] double NormalizedHeading(double heading_deg);

/// The pose fit to keep. An invalid latitude or longitude takes the whole pose with it; altitude
/// and heading fall alone.
[[nodiscard]] std::optional<model::Pose> JudgePose(Violations& violations, const Path& path,
                                                   const RawPose& raw);

}  // namespace uplink::schema
