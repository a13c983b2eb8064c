#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "schema/base/clock.h"
#include "schema/model/ids.h"
#include "schema/model/record.h"
#include "server/ingest/allowances.h"
#include "server/journal/journal.h"
#include "server/robot/held_back.h"
#include "server/robot/robot.h"

namespace uplink::ingest {

using robot::HeldBack;

/// The robot of one stream's messages, and what the journal needs to append their records. The
/// references must outlive the call that takes the Line.
struct Line {
  robot::Robot& robot;
  /// As its records name it.
  storage::RobotRef id;
  journal::Journal& journal;
  model::SessionId session;
  journal::AppendedBy by;
  /// The client that learns of commits, if it is not the robot.
  robot::CommitClient* client = nullptr;

  [[nodiscard]] robot::CommitClient& appends_for() const {
    return client == nullptr ? robot : *client;
  }
};

/// Who waits while a message has no room.
enum class Waits : std::uint8_t {
  /// Its own stream waits until its robot has room.
  kStream,
  /// All robots of its broker wait, since their messages come in one order (QoS 1). So a message
  /// waits only if no robot has room, and is rejected past its own robot's flow. The flow counts
  /// only while the journal or the disk is short: otherwise our acks slow the publisher down, and a
  /// backlog after an outage is legitimate.
  kBroker,
  /// No sender waits (QoS 0): a message without room is refused, and rejected past its robot's
  /// flow.
  kNoOne,
};

/// What the records of a message cost.
struct RecordCost {
  /// Bytes of the journal that they take (journal::CostOf), with the gap before them.
  std::size_t journal_bytes = 0;
  /// Bytes that the robot's flow counts (FlowBytes); empty if it does not count them.
  std::optional<std::size_t> flow_bytes{};
};

/// Bytes that the flow counts of a durable message: of its payload, or of the judged message if
/// that is larger, since that is what is stored and sent to others.
[[nodiscard]] std::size_t FlowBytes(std::size_t payload_bytes, const model::Record& record);

/// Why a message cannot be taken now.
struct Block {
  HeldBack by = HeldBack::kNone;
  /// When to look again, if only time ends the block (kFlow, kDisk, kMalformed).
  std::optional<SteadyTime> until{};
  /// Its robot alone asks for too much: the message is rejected, and does not wait.
  bool is_excess = false;

  /// The message can be taken.
  [[nodiscard]] bool none() const { return by == HeldBack::kNone; }
};

/// What decides whether there is room. The references must outlive the call.
struct RoomTerms {
  const Clock& clock;
  const robot::FlowLimits& flow;
  /// Records of one robot that may wait (limits.in_flight_uplinks_max); for kStream alone.
  std::size_t in_flight_max = 0;
  /// The journals are more than half full; for kBroker alone.
  bool journal_over_half = false;
};

/// What blocks records of that cost: the first reason that applies, in the order of HeldBack. It
/// may end at any time, since other threads commit and fill the journal.
[[nodiscard]] Block FindBlock(const Line& line, Waits waits, const RecordCost& cost,
                              const RoomTerms& terms);

}  // namespace uplink::ingest
