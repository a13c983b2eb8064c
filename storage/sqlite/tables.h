#pragma once

#include <array>
#include <cstddef>

#include <absl/status/status.h>

#include "storage/present.h"
#include "storage/sqlite/claim_tables.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/deciding_tables.h"
#include "storage/sqlite/live_table.h"
#include "storage/sqlite/present_rows.h"
#include "storage/sqlite/retention_tables.h"
#include "storage/sqlite/robot_connections.h"
#include "storage/sqlite/set_aside_tables.h"
#include "storage/sqlite/table_writers.h"

namespace uplink::storage::sqlite {

/// All statements of one writer, prepared once.
struct Tables {
  DecidingTables deciding;
  ClaimTables claims;
  SetAsideTables set_aside;
  TableWriters rows;
  /// By PresentKind.
  std::array<PresentRows, kPresentKinds> present;
  RetentionTables retention;
  RobotConnections connections;
  LiveTable live;

  [[nodiscard]] absl::Status Prepare(Database& database) {
    absl::Status status = deciding.Prepare(database);
    if (status.ok()) status = claims.Prepare(database);
    if (status.ok()) status = set_aside.Prepare(database);
    if (status.ok()) status = rows.Prepare(database);
    for (std::size_t kind = 0; kind < kPresentKinds; ++kind) {
      if (status.ok()) status = present[kind].Prepare(database, static_cast<PresentKind>(kind));
    }
    if (status.ok()) status = retention.Prepare(database);
    if (status.ok()) status = connections.Prepare(database);
    if (status.ok()) status = live.Prepare(database);
    return status;
  }
  [[nodiscard]] PresentRows& present_rows(PresentKind kind) {
    return present[static_cast<std::size_t>(kind)];
  }
};

}  // namespace uplink::storage::sqlite
