#pragma once

#include <optional>

#include "schema/base/clock.h"
#include "schema/model/connection.h"
#include "schema/model/ids.h"
#include "schema/model/presence.h"
#include "storage/epoch.h"
#include "storage/identity.h"

namespace uplink::storage {

/// The last change of a robot's presence that the store has.
struct StoredPresence {
  model::Presence presence = model::Presence::kUnknown;
  SystemTime since;
  /// Until when the robot is parked, to the millisecond; it may have passed. Empty: it is not.
  std::optional<SystemTime> parked_until{};

  friend bool operator==(const StoredPresence&, const StoredPresence&) = default;
};

/// The presence of a robot changed, or until when it is parked: a record that the server makes
/// itself.
struct PresenceItem {
  RobotRef robot;
  model::Presence presence = model::Presence::kUnknown;
  SystemTime at;
  /// From 1, in order, in the session of the process (Batch.presence_session).
  model::Seq number = 0;
  /// As CommitRecord's: only who holds the robot judges it.
  Epoch held_since = 0;
  /// Of a robot that goes offline: why its last connection ended. Nothing if that is unknown, and
  /// of other presences.
  std::optional<model::ConnectionEnd> why{};
  /// As StoredPresence's.
  std::optional<SystemTime> parked_until{};
  /// False: the presence, and since when, are those before, and only parked_until differs. Then no
  /// row of a history is written.
  bool changes_presence = true;
};

}  // namespace uplink::storage
