#pragma once

#include <vector>

#include "schema/base/clock.h"
#include "schema/model/ids.h"
#include "storage/commit_record.h"
#include "storage/connection.h"
#include "storage/deliveries.h"
#include "storage/epoch.h"
#include "storage/identity.h"
#include "storage/presence.h"

namespace uplink::storage {

/// A range of numbers that an agent skipped. Has no number of its own; writing it twice is writing
/// it once (key: robot, session, first).
struct GapItem {
  RobotRef robot;
  model::SessionId session;
  model::Seq first = 0;
  model::Seq last = 0;
  Epoch held_since = 0;
  SystemTime seen_at;
};

/// What one transaction writes. The records of a robot stand in the order of their numbers, per
/// session.
struct Batch {
  std::vector<CommitRecord> records;
  std::vector<GapItem> gaps;
  /// In number order. Those at or below the cursor of `presence_session` are left out, so that a
  /// lost answer cannot double them.
  std::vector<PresenceItem> presence;
  /// The numbering of `presence`: one session a process and shard, under kServerRuri.
  model::SessionId presence_session;
  /// What is remembered besides, under one lease each.
  std::vector<Deliveries> deliveries{};
  /// Those of one connection in the order in which they were noted.
  std::vector<ConnectionItem> connections{};
};

}  // namespace uplink::storage
