#pragma once

#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "schema/judge.h"
#include "server/fleet/fleet.h"
#include "server/identity/deny_list.h"
#include "server/ingest/allowances.h"
#include "server/journal/shards.h"
#include "server/log/logger.h"
#include "server/robot/connection_reports.h"
#include "server/session/forward_source.h"
#include "server/session/limits.h"
#include "server/session/probe.h"
#include "server/session/reject_source.h"
#include "server/transport/probe.h"

namespace uplink::front {

/// The parts that the relay uses. All of them outlive the server.
struct RelayContext {
  const Clock& clock;
  fleet::Fleet& fleet;
  const journal::Shards& journals;
  session::SessionProbe& session_probe;
  transport::RelayProbe& probe;
  /// Each thread takes a page.
  metrics::LedgerBook& ledgers;
  const session::SessionLimits& limits;
  schema::JudgeLimits judge_limits;
  /// What one robot may send; a reload changes it.
  const ingest::Allowances& allowances;
  /// Reads from the store the Rejects that an agent did not confirm.
  session::RejectSource& rejects;
  const storage::ClockTrust& clock_trust;
  /// What other robots share, for streams that ask for it; null: nothing is forwarded.
  session::ForwardSource* forwards = nullptr;
  /// For lines about what strangers do; none if null.
  const log::Logger* logger = nullptr;
  /// Where streams are reported when they begin and end; null: nowhere.
  robot::ConnectionReports* reports = nullptr;
  /// Certificates and keys that are turned away; null: none.
  const identity::DenyList* denied = nullptr;
};

}  // namespace uplink::front
