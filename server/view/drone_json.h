#pragma once

#include <boost/json.hpp>

#include "server/uncrew/drones.h"
#include "server/view/queries.h"

namespace uplink::view {

/// The latest samples of a drone's calls, as `Robot.uncrew`: each type by its name, those with keys
/// by key. A type that was never reported is absent. Pure.
[[nodiscard]] boost::json::object DroneJson(const uncrew::LiveSamples& live);

/// Adds to a robot that calls this process its open requests and, with `with_parts`, all its
/// samples. Null `drones`: none call. Returns the bytes of the samples copied. Any thread.
std::size_t CopyDrone(const uncrew::Drones* drones, bool with_parts, RobotView& robot);

}  // namespace uplink::view
