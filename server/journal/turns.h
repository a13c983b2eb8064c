#pragma once

#include <optional>
#include <stop_token>
#include <utility>

#include "schema/base/clock.h"
#include "server/journal/adopting.h"
#include "server/journal/checkpoint_rounds.h"
#include "server/journal/claiming.h"
#include "server/journal/committing.h"
#include "server/journal/comparing.h"
#include "server/journal/connection_ends.h"
#include "server/journal/expiry_sweep.h"
#include "server/journal/holds.h"
#include "server/journal/limits.h"
#include "server/journal/opening.h"
#include "server/journal/quarantine_trim.h"
#include "server/journal/retention.h"
#include "server/journal/writer_context.h"
#include "storage/identity.h"

namespace uplink::journal {

/// The writer's side of a journal: decides whose turn it is. Opening, Adopting, Claiming,
/// Committing and the duties do the steps.
///
/// Thread: confined to the writer.
class Turns final {
 public:
  /// All of `context` outlives it. `process` numbers the changes of presence.
  Turns(const WriterContext& context, const JournalLimits& limits,
        const storage::ProcessId& process);

  /// Before the first Advance: CheckpointRounds::SetSource.
  void CheckpointFrom(fleet::LiveSource& live, milliseconds every) {
    checkpoints_.SetSource(live, every);
  }

  /// Before the first Advance: ConnectionEnds::Begin.
  void EndConnections(IsOver is_over) { connection_ends_.Begin(std::move(is_over)); }

  /// Does the next step. OpenStreams, the commit and the report of its outcomes are separate steps,
  /// so that a test can stop the process between any two.
  Step Advance();
  /// Waits until something is queued, until the next duty is due, or until `stop`.
  void WaitForWork(const std::stop_token& stop);

 private:
  /// Opens streams, adopts or lets go of robots, or claims drones; commits alternate with these.
  /// Empty if nothing waits.
  std::optional<Step> AdvanceWork();
  /// Empty if no robot changes hands and no drone waits to be claimed.
  std::optional<Step> AdvanceHands();
  bool GatherOpens();
  /// Deletes rows that expired, are too old, or exceed their bound, or ends connections that were
  /// left open; empty if no duty is due.
  std::optional<Step> AdvanceDuty();

  const Clock& clock_;
  WriterInbox& inbox_;
  Holds holds_;
  Comparing comparing_;
  Opening opening_;
  Adopting adopting_;
  Claiming claiming_;
  Committing committing_;
  ExpirySweep expiry_sweep_;
  Retention retention_;
  QuarantineTrim quarantine_trim_;
  ConnectionEnds connection_ends_;
  CheckpointRounds checkpoints_;
  /// The last call opened streams, adopted or claimed while records waited, which are next.
  bool batch_turn_ = false;
  /// The last call was a duty's: waiting work is next.
  bool after_duty_ = false;
  /// The last call was for waiting work: a checkpoint that is due is next.
  bool after_work_ = false;
};

}  // namespace uplink::journal
