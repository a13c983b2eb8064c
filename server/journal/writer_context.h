#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "schema/model/ids.h"
#include "server/journal/duty.h"
#include "server/journal/events.h"
#include "server/journal/probe.h"
#include "server/journal/quarantine_notes.h"
#include "server/journal/store_errors.h"
#include "server/journal/went_back.h"
#include "server/journal/writer_inbox.h"

namespace uplink::storage {
class Store;
}  // namespace uplink::storage

namespace uplink::journal {

/// The result of one step of the writer.
enum class Step : std::uint8_t {
  /// Nothing waits.
  kIdle,
  /// One step was done: streams opened, a batch committed, or its outcomes reported.
  kWorked,
  /// The store failed; the same work is tried again by a later step, after a pause.
  kFailed,
};

/// What the steps and duties of one journal share. Everything outlives them.
struct WriterContext {
  storage::Store& store;
  const Clock& clock;
  metrics::Ledger& ledger;
  JournalProbe& probe;
  WriterInbox& inbox;
  StoreErrors& errors;
  QuarantineNotes& quarantine;
  DutyError& retain_error;
  DutyError& checkpoint_error;
  WentBackNotes& went_back;
  /// Journal::OnSpatial; empty if nothing listens.
  const std::function<void()>& spatial_committed;
  /// Journal::OnReconnected; empty if nothing listens.
  const std::function<void(Reconnected)>& store_reconnected;
  /// Journal::OnSlowCommit; empty if nothing listens.
  const std::function<void(const SlowCommit&)>& slow_commit;
  /// Journal::OnMoved; empty if nothing listens.
  const std::function<void(const Moved&)>& moved;
};

/// Tells the listener that the robot moved to the fleet of `robot`, if it did.
inline void TellMove(const WriterContext& context, const model::RobotId& robot,
                     const std::optional<std::string>& moved_from, const std::string& gateway) {
  if (!moved_from || !context.moved) return;
  context.moved({.ruri = robot.ruri, .from = *moved_from, .to = robot.fleet, .gateway = gateway});
}

}  // namespace uplink::journal
