#pragma once

#include "server/cyberwave/twin_parts.h"
#include "server/rcan/named_series.h"

namespace uplink::rcan {

/// Adds the values of one robot of a twin. Where several messages say a value, the one that arrived
/// later is shown. Series without a word of the twin's own come first, then edges, then joints,
/// then metrics, as AddRobot has it. Whether the values of the robot are shown at all is the
/// caller's to know. Called under the twin's lock.
void AddTwin(const cyberwave::TwinParts& parts, NamedSeries& series);

/// The angle by which that turns x towards y, radians, as seen from above; the quaternion may be of
/// any length but 0. Pure.
[[nodiscard]] double HeadingOf(const model::cyberwave::Rotation& rotation);

}  // namespace uplink::rcan
