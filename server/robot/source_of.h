#pragma once

#include <string_view>

#include "schema/model/message_source.h"

namespace uplink::robot {

/// By which way the messages of the robot with this RURI come; of a stand-in, which belongs to no
/// robot, that of the broker. kUplink unless another source owns such RURIs.
///
/// Thread: pure; any thread.
[[nodiscard]] model::MessageSource SourceOf(std::string_view ruri);

}  // namespace uplink::robot
