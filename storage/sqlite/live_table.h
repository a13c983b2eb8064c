#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "storage/identity.h"
#include "storage/live_row.h"
#include "storage/reader.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/statement.h"

namespace uplink::storage::sqlite {

/// The checkpointed live states, one row per robot.
///
/// Errors: those of errors.h. Thread: confined to the thread of its database.
class LiveTable final {
 public:
  [[nodiscard]] absl::Status Prepare(Database& database);

  /// False if `process` does not hold the robot under the row's hold: nothing was written then.
  [[nodiscard]] absl::StatusOr<bool> Upsert(const LiveRow& row, const ProcessId& process);

 private:
  std::unique_ptr<Statement> upsert_;
};

/// Reader::LiveOf.
[[nodiscard]] absl::StatusOr<Reader::LiveRows> ReadLiveOf(Database& database,
                                                          std::span<const std::string> ruris);

}  // namespace uplink::storage::sqlite
