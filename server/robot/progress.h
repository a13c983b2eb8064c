#pragma once

#include <cstdint>
#include <vector>

#include "schema/base/clock.h"
#include "schema/model/ids.h"
#include "server/robot/open_answer.h"
#include "server/robot/rejected_seq.h"
#include "server/robot/session_table.h"

// What a stream learns about its session: when it starts, and for each Ack.
namespace uplink::robot {

/// How far a session is, for an Ack, with the Rejects to write before it.
struct Progress {
  model::Seq through = 0;
  model::Seq judged = 0;
  std::vector<RejectedSeq> rejects;
  /// Arrival times of the durable messages that commits released since the last look, for ack
  /// latency.
  std::vector<SteadyTime> released;
};
/// The result counts as reported. Confined to the owner's lock of `memory`.
[[nodiscard]] Progress TakeProgress(SessionMemory& memory);

/// What a stream learns when it begins a session.
struct Resume {
  /// Welcome.committed_seq.
  model::Seq committed = 0;
  /// Rejects above Hello.settled_seq, ascending, to repeat.
  std::vector<RejectedSeq> rejects;
};

/// The Hello's numbers, and the id under which the store was asked. A value.
struct ResumeFor {
  std::uint64_t open_id = 0;
  model::Seq settled_seq = 0;
  model::Seq judged_seq = 0;
};
/// Computes the contents of Welcome from session memory and, if it has come, the store's answer.
/// Confined to the owner's lock of both.
[[nodiscard]] Resume ResumeOf(SessionMemory& memory, OpenAnswer& open_answer,
                              const ResumeFor& hello);

}  // namespace uplink::robot
