#pragma once

#include <cstddef>
#include <string>

#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "server/fleet/fleet.h"
#include "server/ingest/allowances.h"
#include "server/robot/connection_reports.h"
#include "server/transport/methods.h"
#include "server/uncrew/drones.h"
#include "server/uncrew/probe.h"

namespace uplink::uncrew {

/// The parts that AvatarService uses. All of them outlive the server.
struct AvatarContext {
  /// Measures the time until an answer: it runs on during an event.
  const Clock& watch;
  Drones& drones;
  fleet::Fleet& fleet;
  AvatarProbe& probe;
  /// Each thread takes a page.
  metrics::LedgerBook& ledgers;
  const ingest::Allowances& allowances;
  milliseconds answer_within;
  std::string ruri_template;
  /// limits.in_flight_uplinks_max and limits.payload_bytes_max.
  std::size_t in_flight_max = 0;
  std::size_t payload_bytes_max = 0;
  /// Where the drones' connections are reported; null: nowhere.
  robot::ConnectionReports* reports = nullptr;
};

/// The methods of AvatarService, made for each thread: a Publish call of each type, and
/// SubscribeUAVCommands, which is UNIMPLEMENTED, since the server sends no commands.
[[nodiscard]] transport::MethodsMaker AvatarMethods(AvatarContext context);

}  // namespace uplink::uncrew
