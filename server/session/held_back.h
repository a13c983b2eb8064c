#pragma once

#include <cstddef>
#include <optional>

#include "schema/base/clock.h"
#include "schema/model/record.h"
#include "server/journal/journal.h"
#include "server/robot/held_back.h"
#include "server/robot/robot.h"
#include "server/session/limits.h"

namespace uplink::session {

using robot::HeldBack;

/// What keeps a message from being processed now.
struct Hold {
  HeldBack by = HeldBack::kNone;
  /// When to look again, of those that nobody ends (kFlow, kDisk, kMalformed).
  std::optional<SteadyTime> until{};

  /// Nothing does.
  [[nodiscard]] bool none() const { return by == HeldBack::kNone; }
};

/// What decides whether a stream is held back. All of it outlives the look.
struct HeldBackSources {
  const robot::Robot& robot;
  const journal::Journal& journal;
  /// Null: the robot speaks by itself.
  const journal::GatewayUse* gateway = nullptr;
  const SessionLimits& limits;
  const robot::FlowLimits& flow;
  const Clock& clock;
};

/// What keeps any message: the peer does not read (`outgoing` frames wait for it), or sends too
/// much that is malformed or over its rate.
[[nodiscard]] Hold HoldOfAll(const HeldBackSources& sources, std::size_t outgoing);

/// A record that is to be appended to the journal.
struct RecordCost {
  /// What it holds there (journal::CostOf), with the gap before it.
  std::size_t journal_bytes = 0;
  /// Bytes that the flow counts (FlowBytes); nothing where it does not count.
  std::optional<std::size_t> flow_bytes{};
};

/// What the flow counts of a durable message: the bytes of its payload, or what the judged message
/// holds where that is more, since it is stored and told to others as large as that.
[[nodiscard]] std::size_t FlowBytes(std::size_t payload_bytes, const model::Record& record);

/// What keeps a record: the first that applies, in the order of HeldBack. Other threads commit and
/// fill the journal, so it may be over at once.
[[nodiscard]] Hold HoldOfRecord(const HeldBackSources& sources, const RecordCost& cost);

}  // namespace uplink::session
