#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "schema/base/clock.h"
#include "schema/model/rejection.h"
#include "server/session/attachment.h"
#include "server/session/context.h"
#include "server/session/outgoing.h"

namespace uplink::session {

/// What a Goodbye says. A value.
struct ExpectedBack {
  /// Until when the robot is parked; empty: the Goodbye does not say a usable time.
  std::optional<SystemTime> until;
  /// Why its time was dropped.
  std::optional<model::Rejection> dropped;
};

/// Judges Goodbye.expected_back_unix_ms: a time that is not ahead of `now` is dropped, one past
/// `parked_max` is cut to that. Pure.
[[nodiscard]] ExpectedBack JudgeGoodbye(std::int64_t expected_back_unix_ms, SystemTime now,
                                        milliseconds parked_max);

/// Parks the robot of a stream as a frame with a Goodbye says, or sends a Notice. False if the
/// frame is no RelayRequest.
[[nodiscard]] bool TakeGoodbye(std::string_view bytes, const SessionContext& context,
                               Attachment& robot, Outgoing& outgoing);

}  // namespace uplink::session
