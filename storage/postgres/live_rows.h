#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "storage/live_row.h"
#include "storage/postgres/link/connection.h"
#include "storage/reader.h"
#include "storage/types.h"

namespace uplink::storage::postgres {

/// Store::Checkpoint, in one transaction and one round trip.
[[nodiscard]] absl::StatusOr<std::vector<std::size_t>> WriteLive(
    Connection& connection, std::span<const LiveRow> rows, const ProcessId& process,
    const std::function<absl::Status()>& before_commit);

/// Reader::Live.
[[nodiscard]] absl::StatusOr<std::vector<LiveRow>> ReadLive(Connection& connection,
                                                            std::string_view after);

/// Reader::LiveOf.
[[nodiscard]] absl::StatusOr<Reader::LiveRows> ReadLiveOf(Connection& connection,
                                                          std::span<const std::string> ruris);

}  // namespace uplink::storage::postgres
