#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string_view>
#include <vector>

#include "storage/identity.h"
#include "storage/open_stream.h"
#include "storage/postgres/link/connection.h"

// The statements of Store::OpenStreams.
namespace uplink::storage::postgres {

/// Requests of different robots, by RURI: their places among all requests.
using Wave = std::map<std::string_view, std::size_t>;

/// The place of each statement's answer among those of CallsOf.
enum OpenAnswer : std::size_t {
  /// RURI, epoch, held_since and former fleet of robots that were taken; epoch 0 and no fleet of
  /// those without a row.
  kRobotsAnswer = 0,
  /// RURI and epoch of those that had no row.
  kNewRobotsAnswer = 1,
  /// RURI and cursor.
  kSessionsAnswer = 3,
  /// RURI, number and rejection.
  kRejectsAnswer = 4,
  /// RURI and how many.
  kRejectCountsAnswer = 5,
  kPresenceAnswer = 8,
  /// RURI and LatestKind.
  kLatestKindsAnswer = 9,
  /// RURI and fleet, of those whose word moves nothing.
  kFleetsAnswer = 10,
};

/// Opens the wave's streams, within a transaction.
[[nodiscard]] std::vector<StoreCall> CallsOf(const Wave& wave,
                                             std::span<const OpenRequest> requests,
                                             const ProcessId& process);

}  // namespace uplink::storage::postgres
