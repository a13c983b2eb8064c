#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "schema/model/rcan.h"
#include "schema/model/record.h"
#include "schema/model/rejection.h"
#include "server/session/context.h"
#include "server/session/frame_view.h"
#include "storage/clock_trust.h"

namespace uplink::session {

/// A judged message, before anything is done for it. It may have to wait, and is judged again then.
/// A value.
struct Judged {
  std::variant<model::Record, model::RcanState, model::Rejection> content;
  /// A kind of the ledger.
  std::size_t kind = metrics::kUnknownKind;
  /// For a Robot State.
  std::vector<model::DroppedField> dropped{};
  std::vector<model::UnlistedFields> unlisted{};
  bool sign_of_life = false;
  metrics::OddCounts odd{};
  /// A durable upsert whose expiry has passed.
  bool expired = false;
};

/// Judges a message of the robot `ruri` that was received at that time. Changes nothing of the
/// robot. On the thread of the context.
[[nodiscard]] Judged JudgeUplink(const SessionContext& context, const std::string& ruri,
                                 const UplinkView& uplink, SystemTime received_at);

/// Whether it is an upsert of a shape or object whose expiry has passed at `now`: such a message is
/// neither stored nor forwarded. False while the clock is not vouched for, so that the message is
/// stored then.
[[nodiscard]] bool ExpiredOnArrival(const model::Body& body, SystemTime now,
                                    const storage::ClockTrust& clock_trust);

}  // namespace uplink::session
