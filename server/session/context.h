#pragma once

#include <atomic>

#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "schema/judge.h"
#include "server/fleet/fleet.h"
#include "server/ingest/allowances.h"
#include "server/journal/shards.h"
#include "server/robot/connection_reports.h"
#include "server/session/forward_source.h"
#include "server/session/frame_live.h"
#include "server/session/frame_view.h"
#include "server/session/limits.h"
#include "server/session/probe.h"
#include "server/session/reject_source.h"
#include "storage/clock_trust.h"

namespace uplink::session {

/// Buffers that the sessions of one thread use one after the other, so that none allocates for a
/// frame.
struct IntakeScratch {
  BatchView batch;
  FrameLive live;
};

/// What sessions share: judge, ledger page and scratch belong to one thread, the rest to the
/// server.
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
  /// Tells whether the civil clock is vouched for.
  const storage::ClockTrust& clock_trust;
  /// Whether connections wait for a place; null if that is unknown.
  const std::atomic<bool>* pressed = nullptr;
  /// What robots of a fleet share; null: nothing is forwarded.
  ForwardSource* forwards = nullptr;
  /// Where streams are reported when they begin and end; null: nowhere.
  robot::ConnectionReports* reports = nullptr;
};

}  // namespace uplink::session
