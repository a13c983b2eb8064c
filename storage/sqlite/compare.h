#pragma once

#include <absl/status/statusor.h>

#include "storage/compare.h"

namespace uplink::storage::sqlite {

class DecidingTables;

/// Store::Compare of one robot, for this process, within a transaction.
[[nodiscard]] absl::StatusOr<FoundRobot> CompareWith(DecidingTables& deciding,
                                                     const ToldRobot& robot,
                                                     const ProcessId& process);

}  // namespace uplink::storage::sqlite
