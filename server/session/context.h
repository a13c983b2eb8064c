#pragma once

#include <atomic>

#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "schema/judge.h"
#include "server/fleet/fleet.h"
#include "server/ingest/allowances.h"
#include "server/journal/shards.h"
#include "server/session/forward_source.h"
#include "server/session/frame_live.h"
#include "server/session/frame_view.h"
#include "server/session/limits.h"
#include "server/session/probe.h"
#include "server/session/reject_source.h"
#include "storage/clock_trust.h"

namespace uplink::session {

/// What the sessions of one thread use one after the other, so that none needs memory of its own
/// for a frame.
struct IntakeScratch {
  BatchView batch;
  FrameLive live;
};

/// What a whole server shares with its sessions, and what the sessions of one thread share: the
/// judge, the ledger page and the scratch are that thread's.
struct SessionContext {
  const Clock& clock;
  fleet::Fleet& fleet;
  const journal::Shards& journals;
  SessionProbe& probe;
  metrics::Ledger& ledger;
  schema::Judge& judge;
  const SessionLimits& limits;
  IntakeScratch& scratch;
  const ingest::Allowances& allowances;
  RejectSource& rejects;
  /// Who vouches for the civil clock.
  const storage::ClockTrust& clock_trust;
  /// Others wait for a place among the connections; null: nobody can tell.
  const std::atomic<bool>* pressed = nullptr;
  /// What robots of a fleet share; null: nothing is forwarded.
  ForwardSource* forwards = nullptr;
};

}  // namespace uplink::session
