#pragma once

#include <boost/json.hpp>

#include "server/uncrew/drones.h"
#include "server/view/queries.h"

namespace uplink::view {

/// What a drone's calls said, as `Robot.uncrew`: each type by its name, those with keys by key. A
/// type that was never said is absent. Pure.
[[nodiscard]] boost::json::object DroneJson(const uncrew::LiveSamples& live);

/// Adds to a robot what its calls said, and with `with_parts` all of it, unless it does not call
/// here. Null `drones`: none call. Returns the bytes that were copied. Any thread.
std::size_t CopyDrone(const uncrew::Drones* drones, bool with_parts, RobotView& robot);

}  // namespace uplink::view
