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

  friend bool operator==(const StoredPresence&, const StoredPresence&) = default;
};

/// The presence of a robot changed: a record that the server makes itself.
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
};

}  // namespace uplink::storage
