#pragma once

#include <optional>

#include "schema/model/rcan.h"
#include "schema/model/value.h"
#include "server/rcan/named_series.h"
#include "server/robot/robot_state.h"

namespace uplink::rcan {

/// Adds the samples of a robot's joints: from its Robot State, and from extras with the key
/// `joint/<name>/<field>_<unit>`. If both have a value, the later one is shown.
void AddJoints(const robot::StateView& view, NamedSeries& series);
/// The same from a Robot State alone.
void AddJoints(const model::RcanState& state, NamedSeries& series);

/// A finite number, or a boolean as 0 or 1; empty for any other value.
[[nodiscard]] std::optional<double> NumberOf(const model::Value& value);

}  // namespace uplink::rcan
