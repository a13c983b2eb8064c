#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "storage/identity.h"
#include "storage/live_row.h"
#include "storage/postgres/link/connection.h"
#include "storage/reader.h"

namespace uplink::storage::postgres {

/// Who writes live states.
struct LiveWriter {
  ProcessId process{};
  /// Counts its store calls; of each robot all come from one writer. One that comes after one with
  /// a greater number of the same hold writes nothing.
  std::uint64_t store_call = 0;
};

/// Store::Checkpoint, in one transaction and one round trip.
[[nodiscard]] absl::StatusOr<std::vector<std::size_t>> WriteLive(
    Connection& connection, std::span<const LiveRow> rows, const LiveWriter& writer,
    const std::function<absl::Status()>& before_commit);

/// Reader::LiveOf.
[[nodiscard]] absl::StatusOr<Reader::LiveRows> ReadLiveOf(Connection& connection,
                                                          std::span<const std::string> ruris);

}  // namespace uplink::storage::postgres
