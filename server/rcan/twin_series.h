#pragma once

#include "metrics/rcan/page.h"
#include "server/cyberwave/twin_parts.h"
#include "server/rcan/named_series.h"

namespace uplink::rcan {

/// Adds those values of one robot of a twin that carry no word of the twin's own. Where several
/// messages say a value, the one that arrived later is shown. The caller knows whether the values
/// of the robot are shown at all. Called under the twin's lock.
void AddTwinBasic(const cyberwave::TwinParts& parts, metrics::rcan::SeriesPage& page);

/// Adds its other values: edges, then joints, then metrics, as AddNamed has it. Called under the
/// twin's lock.
void AddTwinNamed(const cyberwave::TwinParts& parts, NamedSeries& series);

/// The angle by which that turns x towards y, radians, as seen from above; the quaternion may be of
/// any length but 0. Pure.
[[nodiscard]] double HeadingOf(const model::cyberwave::Rotation& rotation);

}  // namespace uplink::rcan
