#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/model/mission.h"
#include "schema/model/reports.h"
#include "schema/model/spatial.h"
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

/// What shapes and objects have in common: rows by id that expire.
class PresentRows final {
 public:
  [[nodiscard]] absl::Status Prepare(Database& database, const std::string& table);

  /// When the row expires; nothing if there is none.
  [[nodiscard]] absl::StatusOr<std::optional<std::int64_t>> ExpiryOf(std::string_view ruri,
                                                                     std::string_view id);
  /// A robot's rows, expired ones included.
  [[nodiscard]] absl::StatusOr<std::size_t> Count(std::string_view ruri);
  [[nodiscard]] absl::Status Delete(std::string_view ruri, std::string_view id);
  /// Deletes a robot's rows that have expired by `now_ms`; returns how many.
  [[nodiscard]] absl::StatusOr<std::size_t> DeleteExpired(std::string_view ruri,
                                                          std::int64_t now_ms);
  /// Deletes at most `rows_max` rows that expired by `until_ms`, the first to expire first.
  [[nodiscard]] absl::StatusOr<std::size_t> Sweep(std::int64_t until_ms, std::size_t rows_max);

 private:
  std::unique_ptr<Statement> expiry_, count_, delete_, delete_expired_, sweep_;
};

/// Present shapes.
class ShapeTable final {
 public:
  [[nodiscard]] absl::Status Prepare(Database& database);
  /// Replaces a row of that id, which keeps first_ms and entry.
  [[nodiscard]] absl::Status Upsert(const CommitRecord& record, const model::ReportedShape& shape,
                                    EntryNumber entry);
  [[nodiscard]] PresentRows& rows() { return rows_; }

 private:
  PresentRows rows_;
  std::unique_ptr<Statement> upsert_;
};

/// Present objects.
class ObjectTable final {
 public:
  [[nodiscard]] absl::Status Prepare(Database& database);
  /// As ShapeTable::Upsert; `expires_ms` is the effective one.
  [[nodiscard]] absl::Status Upsert(const CommitRecord& record, const model::Object& object,
                                    std::int64_t expires_ms, EntryNumber entry);
  [[nodiscard]] PresentRows& rows() { return rows_; }

 private:
  PresentRows rows_;
  std::unique_ptr<Statement> upsert_;
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
