#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "schema/base/clock.h"
#include "schema/model/ids.h"
#include "server/robot/held_back.h"
#include "server/robot/session_table.h"
#include "server/robot/takeover.h"
#include "storage/live_row.h"

namespace uplink::robot {

/// For views: the session of the robot's stream, or of its last one.
struct SessionView {
  bool connected = false;
  SystemTime connected_since;
  std::optional<model::SessionId> session;
  model::Seq settled_seq = 0;
  std::uint64_t missing = 0;
  /// The gateway of that stream; empty: the robot spoke by itself, or never here.
  std::string gateway = {};
  /// More than kTakeoversPerMinuteMax takeovers in the last minute.
  bool contested = false;
  /// Why and since when the robot's stream is not read.
  HeldBack held_back = HeldBack::kNone;
  SystemTime held_back_since;
};

/// The view of a robot's stream, without its session. Confined to the owner's lock of both.
[[nodiscard]] SessionView ViewOf(const Takeover& takeover, const HeldBackTrack& held_back);

/// How far the session is settled; empty if it is not in memory, and `memory` null.
[[nodiscard]] std::optional<storage::SettledSession> SettledOf(
    const SessionMemory* memory, const std::optional<model::SessionId>& session);

}  // namespace uplink::robot
