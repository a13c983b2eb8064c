#pragma once

#include <optional>

#include "metrics/rcan/page.h"
#include "schema/model/value.h"
#include "server/robot/robot_state.h"

namespace uplink::rcan {

/// Adds the samples of a robot's joints: of its Robot State, and of extras with the key
/// `joint/<name>/<field>_<unit>`. Where both say a value, the one that came later is shown.
void AddJoints(const robot::StateView& view, metrics::rcan::SeriesPage& page);

/// A number or a boolean (0 or 1); nothing of other values, and of a number that is not finite.
[[nodiscard]] std::optional<double> NumberOf(const model::Value& value);

}  // namespace uplink::rcan
