#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include "schema/base/clock.h"
#include "schema/model/ids.h"
#include "server/robot/numbering.h"
#include "server/robot/reject_memory.h"
#include "storage/compare.h"

namespace uplink::robot {

/// The memory of one session.
struct SessionMemory {
  Numbering numbers;
  RejectMemory rejects;
  /// The highest number that the store has confirmed as committed.
  model::Seq committed = 0;
  /// The number up to which the agent knows its messages judged, by its last Hello.
  model::Seq known_judged = 0;
  /// Arrival times of messages that commits released and the stream has not taken yet: at most
  /// in_flight_uplinks_max.
  std::vector<SteadyTime> released;
  SteadyTime last_used;
};

/// The sessions of one robot, at most kSessionsMax. A session that waits for commits is never
/// forgotten. Confined to its owner's lock.
class SessionTable final {
 public:
  /// Null if it is not in memory.
  [[nodiscard]] SessionMemory* Find(const model::SessionId& session);
  [[nodiscard]] const SessionMemory* Find(const model::SessionId& session) const;
  /// The session, created if it is not in memory; if there is no room, the least recently used idle
  /// one is forgotten. Null if all of them wait for commits.
  [[nodiscard]] SessionMemory* FindOrCreate(const model::SessionId& session);
  [[nodiscard]] std::vector<model::SessionId> Ids() const;
  /// Sessions that have commits.
  [[nodiscard]] std::vector<storage::CommittedSession> Committed() const;
  /// Messages of all sessions that wait for their commit.
  [[nodiscard]] std::size_t waiting() const;
  /// Forgets the sessions but `in_use` that were last used more than `idle` ago and wait for
  /// nothing.
  void ForgetIdle(SteadyTime now, milliseconds idle, const std::optional<model::SessionId>& in_use);
  /// Forgets all sessions, also waiting ones.
  void Clear() { sessions_.clear(); }

 private:
  /// False if there is no room for another.
  bool MakeRoom();

  std::map<model::SessionId, SessionMemory> sessions_;
};

}  // namespace uplink::robot
