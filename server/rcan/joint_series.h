#pragma once

#include <optional>

#include "schema/model/rcan.h"
#include "schema/model/value.h"
#include "server/rcan/named_series.h"
#include "server/robot/robot_state.h"

namespace uplink::rcan {

/// Adds the samples of a robot's joints: of its Robot State, and of extras with the key
/// `joint/<name>/<field>_<unit>`. Where both say a value, the one that came later is shown.
void AddJoints(const robot::StateView& view, NamedSeries& series);
/// The same of a Robot State alone.
void AddJoints(const model::RcanState& state, NamedSeries& series);

/// A number or a boolean (0 or 1); nothing of other values, and of a number that is not finite.
[[nodiscard]] std::optional<double> NumberOf(const model::Value& value);

}  // namespace uplink::rcan
