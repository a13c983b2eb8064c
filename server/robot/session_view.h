#pragma once

#include <optional>

#include "schema/model/ids.h"
#include "server/robot/held_back.h"
#include "server/robot/robot_sessions.h"
#include "server/robot/session_table.h"
#include "server/robot/takeover.h"
#include "storage/live_row.h"

namespace uplink::robot {

/// What a view shows of a robot's stream; of its session nothing yet. Confined to the owner's lock
/// of both.
[[nodiscard]] SessionView ViewOf(const Takeover& takeover, const HeldBackTrack& held_back);

/// How far the session is settled; nothing if it is not held, and `memory` null.
[[nodiscard]] std::optional<storage::SettledSession> SettledOf(
    const SessionMemory* memory, const std::optional<model::SessionId>& session);

}  // namespace uplink::robot
