#pragma once

#include <string>

#include "schema/base/clock.h"
#include "schema/model/ids.h"
#include "schema/model/rejection.h"
#include "server/session/limits.h"
#include "storage/latest_kind.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::session {

/// The contract's value of a reason; the two enumerations agree (checked at compile time).
[[nodiscard]] v1::RejectReason ToWire(model::RejectReason reason);

/// The frames that a session sends. They make texts printable and cut them to their limits.
[[nodiscard]] v1::RelayResponse WelcomeFrame(const std::string& ruri, model::Seq committed,
                                             const SessionLimits& limits, SystemTime now);
[[nodiscard]] v1::RelayResponse AckFrame(model::Seq through, model::Seq judged);
[[nodiscard]] v1::RelayResponse RejectFrame(model::Seq seq, const model::Rejection& rejection,
                                            std::int64_t retry_after_ms = 0);
[[nodiscard]] v1::RelayResponse NoticeFrame(model::Seq seq, const model::Rejection& dropped);
[[nodiscard]] v1::RelayResponse ResendRequestFrame(storage::LatestKindSet kinds);
[[nodiscard]] v1::RelayResponse DrainFrame(milliseconds grace);

}  // namespace uplink::session
