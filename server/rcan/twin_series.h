#pragma once

#include "metrics/rcan/page.h"
#include "server/cyberwave/twin_parts.h"
#include "server/rcan/named_series.h"

namespace uplink::rcan {

/// Adds the values of one robot of a twin that carry no name of the twin's own. If several messages
/// have a value, the one that arrived last is shown. The caller decides whether the robot's values
/// are shown at all. Call it under the twin's lock.
void AddTwinBasic(const cyberwave::TwinParts& parts, metrics::rcan::SeriesPage& page);

/// Adds its other values, as AddNamed: edges, then joints, then metrics. Call it under the twin's
/// lock.
void AddTwinNamed(const cyberwave::TwinParts& parts, NamedSeries& series);

/// The angle by which the rotation turns x towards y, in radians, seen from above. The quaternion
/// may have any length but 0. Pure.
[[nodiscard]] double HeadingOf(const model::cyberwave::Rotation& rotation);

}  // namespace uplink::rcan
