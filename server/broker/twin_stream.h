#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "schema/model/ids.h"
#include "server/broker/twin_connections.h"
#include "server/broker/waiting_message.h"
#include "server/cyberwave/twin.h"
#include "server/cyberwave/twin_rates.h"
#include "server/fleet/fleet.h"
#include "server/ingest/room.h"
#include "server/journal/journal.h"
#include "server/limits/recent_times.h"
#include "server/loop/wake.h"

namespace uplink::broker {

/// The records of one robot of a twin, or of a stand-in (storage::NoRobotOf): its messages are
/// numbered by arrival, in a session of its own. Confined to its owner's thread.
struct TwinStream {
  fleet::RobotPtr robot;
  /// Null for a stand-in.
  cyberwave::TwinPtr twin;
  /// Shared by a twin's two robots.
  std::shared_ptr<cyberwave::TwinRates> rates;
  /// As loop::StreamRef names it; from 1.
  std::uint64_t id = 0;
  loop::StreamRef self;
  model::SessionId session;
  /// Goes with every record (journal::Journal::Append).
  std::uint64_t generation = 0;
  model::Seq last_seq = 0;
  journal::Journal* journal = nullptr;
  /// In order of their numbers.
  std::deque<WaitingMessage> waiting;
  /// Packet ids of messages that were settled without a record since the last one with records, and
  /// of some that are forgotten. The next records carry them into the store (Commits::Number). An
  /// id belongs to one twin at a time, so all twins together hold hardly more entries than there
  /// are ids.
  std::vector<std::uint16_t> settled;
  SteadyTime used_at;
  TwinConnections connections;
  /// When the log last named it for its rate (LimitedLog).
  limits::RecentTimes<1> limited_told;
  /// It takes no more messages, and goes once no message of it waits. It may be revived before.
  bool ending = false;
  /// An operator ended it: it goes once no message of it waits.
  bool ended = false;

  [[nodiscard]] const std::string& ruri() const { return robot->ruri(); }
  /// The stream as the port takes it.
  [[nodiscard]] ingest::Line line() const {
    return {.robot = *robot,
            .id = robot->id(),
            .journal = *journal,
            .session = session,
            .by = generation};
  }
};

}  // namespace uplink::broker
