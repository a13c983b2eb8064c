#pragma once

#include <array>
#include <cstddef>

#include <absl/status/status.h>

#include "storage/present.h"
#include "storage/sqlite/changes_table.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/deciding_tables.h"
#include "storage/sqlite/live_table.h"
#include "storage/sqlite/open_runs.h"
#include "storage/sqlite/present_rows.h"
#include "storage/sqlite/quarantine_bound.h"
#include "storage/sqlite/retention_tables.h"
#include "storage/sqlite/set_aside_tables.h"
#include "storage/sqlite/table_writers.h"
#include "storage/sqlite/topic_tables.h"

namespace uplink::storage::sqlite {

/// All statements of one writer, prepared once.
struct Tables {
  DecidingTables deciding;
  SetAsideTables set_aside;
  TableWriters rows;
  /// By PresentKind.
  std::array<PresentRows, kPresentKinds> present;
  OpenRuns open_runs;
  QuarantineBound quarantine_bound;
  RetentionTables retention;
  LiveTable live;
  ChangesTable changes;
  TopicTables topics;

  [[nodiscard]] absl::Status Prepare(Database& database);
  [[nodiscard]] PresentRows& present_rows(PresentKind kind) {
    return present[static_cast<std::size_t>(kind)];
  }
};

}  // namespace uplink::storage::sqlite
