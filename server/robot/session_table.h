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

/// What is held of one session.
struct SessionMemory {
  Numbering numbers;
  RejectMemory rejects;
  /// The highest number that the store said is committed.
  model::Seq committed = 0;
  /// What the agent knows to be judged, by its last Hello.
  model::Seq known_judged = 0;
  /// Arrivals of what commits released and the stream has not taken yet: at most
  /// in_flight_uplinks_max.
  std::vector<SteadyTime> released;
  SteadyTime last_used;
};

/// The sessions of one robot, at most kSessionsMax. One that waits for commits is never forgotten.
/// Confined to its owner's lock.
class SessionTable final {
 public:
  /// Null if it is not held.
  [[nodiscard]] SessionMemory* Find(const model::SessionId& session);
  [[nodiscard]] const SessionMemory* Find(const model::SessionId& session) const;
  /// The session, created if it is not held; the least recently used idle one is forgotten where
  /// there is no room. Null if all of them wait for commits.
  [[nodiscard]] SessionMemory* FindOrCreate(const model::SessionId& session);
  [[nodiscard]] std::vector<model::SessionId> Ids() const;
  /// Those of which the store said that something is committed.
  [[nodiscard]] std::vector<storage::CommittedSession> Committed() const;
  /// Messages of all sessions that wait for their commit.
  [[nodiscard]] std::size_t waiting() const;
  /// Forgets the sessions but `in_use` that were last used more than `idle` ago and wait for
  /// nothing.
  void ForgetIdle(SteadyTime now, milliseconds idle, const std::optional<model::SessionId>& in_use);
  /// Forgets all, also what waits.
  void Clear() { sessions_.clear(); }

 private:
  /// False if there is no room for one more.
  bool MakeRoom();

  std::map<model::SessionId, SessionMemory> sessions_;
};

}  // namespace uplink::robot
