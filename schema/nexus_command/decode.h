#pragma once

#include <string_view>

#include <absl/status/statusor.h>

#include "schema/nexus_command/command.h"

namespace uplink::nexus_command {

/// Reads one serialized NexusCommand: standard stream framing, not packed. For programs that play
/// a robot: the synthetic fleet and the tests.
///
/// Errors:  kInvalidArgument, in words, for what is no well-formed command, for a member that the
///          server does not send, and for content that no robot could have reported. No input makes
///          it throw or abort.
/// Limits:  kCommandBytesMax, and those of judgement (schema/limits.h).
/// Thread:  pure; any thread.
[[nodiscard]] absl::StatusOr<Command> Decode(std::string_view bytes);

}  // namespace uplink::nexus_command
