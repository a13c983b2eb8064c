#pragma once

#include <string_view>

#include "schema/model/message_source.h"

namespace uplink::robot {

/// The source of messages of the robot with this RURI; for a stand-in, which belongs to no robot,
/// the broker. kUplink unless another source owns such RURIs.
///
/// Thread: pure; any thread.
[[nodiscard]] model::MessageSource SourceOf(std::string_view ruri);

}  // namespace uplink::robot
