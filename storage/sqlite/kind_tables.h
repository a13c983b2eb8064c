#pragma once

#include <memory>
#include <string>

#include <absl/status/status.h>

#include "schema/model/mission.h"
#include "schema/model/reports.h"
#include "storage/reader.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/entry_number.h"
#include "storage/sqlite/statement.h"
#include "storage/types.h"

namespace uplink::storage::sqlite {

// The tables of the durable kinds beside faults.
//
// Errors: those of errors.h. Thread: confined to the thread of its database.

/// Events and messages: histories.
class HistoryTables final {
 public:
  [[nodiscard]] absl::Status Prepare(Database& database);
  [[nodiscard]] absl::Status Insert(const CommitRecord& record, const model::EventTelemetry& event,
                                    EntryNumber entry);
  [[nodiscard]] absl::Status Insert(const CommitRecord& record, const model::Message& message,
                                    EntryNumber entry);

 private:
  std::unique_ptr<Statement> insert_event_, insert_message_;
};

/// Mission runs: every report, and each run as it stands.
class MissionTables final {
 public:
  [[nodiscard]] absl::Status Prepare(Database& database);
  [[nodiscard]] absl::Status Insert(const CommitRecord& record,
                                    const model::MissionRunStatus& report, EntryNumber entry);

 private:
  std::unique_ptr<Statement> insert_report_, upsert_run_;
};

/// The latest of a robot's kinds of which one is kept.
class LatestTable final {
 public:
  [[nodiscard]] absl::Status Prepare(Database& database);
  [[nodiscard]] absl::Status Upsert(const CommitRecord& record, LatestKind kind,
                                    const std::string& body_json);

 private:
  std::unique_ptr<Statement> upsert_;
};

/// Changes of presence.
class PresenceTable final {
 public:
  [[nodiscard]] absl::Status Prepare(Database& database);
  [[nodiscard]] absl::Status Insert(const PresenceItem& item, EntryNumber entry);

 private:
  std::unique_ptr<Statement> insert_, upsert_latest_;
};

}  // namespace uplink::storage::sqlite
