#include "schema/base/check.h"
#include "storage/numbers.h"
#include "storage/sqlite/prepare.h"
#include "storage/sqlite/tables.h"
#include "storage/sqlite/values.h"

namespace uplink::storage::sqlite {

absl::Status FaultTables::Prepare(Database& database) {
  Preparer prepare(database);
  prepare.Into(insert_history_,
               "INSERT INTO faults_history (ruri, received_ms, entry, fleet, session, seq,"
               " sampled_ms, fault_id, source, severity, active, category, description,"
               " suggested_action) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  prepare.Into(is_active_,
               "SELECT 1 FROM faults_active WHERE ruri = ? AND fault_id = ? AND source = ?");
  prepare.Into(count_active_, "SELECT COUNT(*) FROM faults_active WHERE ruri = ?");
  prepare.Into(raise_,
               "INSERT INTO faults_active (ruri, fault_id, source, fleet, raised_ms, entry,"
               " received_ms, sampled_ms, severity, category, description, suggested_action)"
               " VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?5, ?7, ?8, ?9, ?10, ?11)"
               " ON CONFLICT (ruri, fault_id, source) DO UPDATE SET fleet = excluded.fleet,"
               " received_ms = excluded.received_ms, sampled_ms = excluded.sampled_ms,"
               " severity = excluded.severity, category = excluded.category,"
               " description = excluded.description,"
               " suggested_action = excluded.suggested_action");
  prepare.Into(clear_, "DELETE FROM faults_active WHERE ruri = ? AND fault_id = ? AND source = ?");
  return prepare.status();
}

absl::Status FaultTables::InsertHistory(const CommitRecord& record, const model::Fault& fault,
                                        EntryNumber entry) {
  const std::int64_t active = fault.active ? 1 : 0;
  return insert_history_->Run(View(record.robot->ruri), UnixMs(record.received_at), entry,
                              View(record.robot->fleet), Blob{record.session.AsBytes()}, record.seq,
                              fault.unix_time_ms, View(fault.fault_id), View(fault.source),
                              NumberOf(fault.severity), active, View(fault.category),
                              View(fault.description), View(fault.suggested_action));
}

absl::StatusOr<bool> FaultTables::IsActive(std::string_view ruri, const model::Fault& fault) {
  return is_active_->Select(ruri, View(fault.fault_id), View(fault.source)).Next();
}

absl::StatusOr<std::size_t> FaultTables::CountActive(std::string_view ruri) {
  Rows rows = count_active_->Select(ruri);
  const absl::StatusOr<bool> found = rows.Next();
  if (!found.ok()) return found.status();
  UPLINK_CHECK(*found, "a count is a row");
  return static_cast<std::size_t>(rows.Int(0));
}

absl::Status FaultTables::Raise(const CommitRecord& record, const model::Fault& fault,
                                EntryNumber entry) {
  return raise_->Run(View(record.robot->ruri), View(fault.fault_id), View(fault.source),
                     View(record.robot->fleet), UnixMs(record.received_at), entry,
                     fault.unix_time_ms, NumberOf(fault.severity), View(fault.category),
                     View(fault.description), View(fault.suggested_action));
}

absl::Status FaultTables::Clear(std::string_view ruri, const model::Fault& fault) {
  return clear_->Run(ruri, View(fault.fault_id), View(fault.source));
}

}  // namespace uplink::storage::sqlite
