#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "schema/base/clock.h"
#include "schema/model/ids.h"
#include "schema/model/operator_request.h"
#include "schema/model/record.h"
#include "schema/model/rejection.h"
#include "schema/model/scope_update.h"
#include "storage/deliveries.h"
#include "storage/epoch.h"
#include "storage/identity.h"
#include "storage/origin.h"
#include "storage/samples.h"

namespace uplink::storage {

/// A rejected payload on its way to quarantine. It stands in its message's place and number.
struct QuarantineItem {
  model::Rejection rejection;
};

/// Consecutive numbers of a session whose messages were over their rates. It has the number of the
/// last of them. No payload is kept: one row holds the rejection that their robot gets for all.
struct LimitedRange {
  /// At most the number in which it stands.
  model::Seq first = 0;
  model::Rejection rejection;
};

/// What a durable message says: a validated record of a robot, the rejected payload in its place,
/// an update of what is no robot (its robot is a stand-in, origin.h), of several messages that they
/// were limited, or that a drone's request to its operator was opened or closed.
using CommitContent = std::variant<model::Record, QuarantineItem, model::ScopeUpdate, LimitedRange,
                                   model::OperatorRequest>;

/// One durable message.
struct CommitRecord {
  RobotRef robot;
  model::SessionId session;
  model::Seq seq = 0;
  /// OpenResult.held_since of the process's hold under which the record is committed.
  Epoch held_since = 0;
  SystemTime received_at;
  CommitContent content;
  /// The serialized payload, for quarantine: of a good record too, since the store may refuse it.
  /// Cut at the size limit; empty where thinning dropped it.
  std::string payload;
  /// Size of the payload as it came.
  std::uint64_t payload_bytes = 0;
  /// Where it came from, for its row of quarantine.
  OriginRef origin{};
  /// Set on the last record of a message that a broker delivered.
  std::optional<MessageEnd> message_end{};
  /// Set on all records of a drone's sample: it decides, in place of `held_since` and of the
  /// session's cursor. The number serves quarantine alone then.
  SampleRef sample{};
};

}  // namespace uplink::storage
