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

/// One stream's way into the server: the robot that its messages are of, and what the journal needs
/// to append their records. What it refers to must outlive the call that it is passed to.
struct Line {
  robot::Robot& robot;
  /// As its records name it.
  storage::RobotRef id;
  journal::Journal& journal;
  model::SessionId session;
  journal::AppendedBy by;
  /// For whom the journal keeps its records, if that is not the robot.
  robot::CommitClient* client = nullptr;

  [[nodiscard]] robot::CommitClient& appends_for() const {
    return client == nullptr ? robot : *client;
  }
};

/// Who waits while a message has no room.
enum class Waits : std::uint8_t {
  /// Its own stream waits, for whatever its robot is short of.
  kStream,
  /// All robots of its broker wait, since their messages come in one order (QoS 1). So a message
  /// waits only where no robot has room, and is rejected past its own robot's flow. Our acks
  /// hold its publisher back, and a backlog after an outage is honest: the flow counts only while
  /// the journal or the disk is short.
  kBroker,
  /// No sender waits (QoS 0): a message without room is refused, and rejected past its robot's
  /// flow.
  kNobody,
};

/// What the records of a message cost.
struct RecordCost {
  /// What they hold in the journal (journal::CostOf), with the gap before them.
  std::size_t journal_bytes = 0;
  /// Bytes that the robot's flow counts (FlowBytes); nothing where it does not count.
  std::optional<std::size_t> flow_bytes{};
};

/// What the flow counts of a durable message: the bytes of its payload, or what the judged message
/// holds where that is more, since it is stored and told to others as large as that.
[[nodiscard]] std::size_t FlowBytes(std::size_t payload_bytes, const model::Record& record);

/// What keeps a message from being taken now.
struct Hold {
  HeldBack by = HeldBack::kNone;
  /// When to look again, of those that nobody ends (kFlow, kDisk, kMalformed).
  std::optional<SteadyTime> until{};
  /// Its robot alone asks for too much: the message is rejected, and does not wait.
  bool is_excess = false;

  /// Nothing does.
  [[nodiscard]] bool none() const { return by == HeldBack::kNone; }
};

/// What decides whether there is room. What it refers to must outlive the call.
struct RoomTerms {
  const Clock& clock;
  const robot::FlowLimits& flow;
  /// Records of one robot that may wait (limits.in_flight_uplinks_max). Of kStream alone.
  std::size_t in_flight_max = 0;
  /// The journals are more than half full. Of kBroker alone.
  bool journal_over_half = false;
};

/// What keeps records of that cost: the first that applies, in the order of HeldBack. Other threads
/// commit and fill the journal, so it may be over at once.
[[nodiscard]] Hold HoldOf(const Line& line, Waits waits, const RecordCost& cost,
                          const RoomTerms& terms);

}  // namespace uplink::ingest
