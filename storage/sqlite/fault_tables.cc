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
  prepare.Into(raise_,
               "INSERT INTO faults_active (ruri, fault_id, source, fleet, raised_ms, entry,"
               " received_ms, sampled_ms, severity, category, description, suggested_action)"
               " VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?5, ?7, ?8, ?9, ?10, ?11)"
               " ON CONFLICT (ruri, fault_id, source) DO UPDATE SET fleet = excluded.fleet,"
               " received_ms = excluded.received_ms, sampled_ms = excluded.sampled_ms,"
               " severity = excluded.severity, category = excluded.category,"
               " description = excluded.description,"
               " suggested_action = excluded.suggested_action");
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

absl::Status FaultTables::Raise(const CommitRecord& record, const model::Fault& fault,
                                EntryNumber entry) {
  return raise_->Run(View(record.robot->ruri), View(fault.fault_id), View(fault.source),
                     View(record.robot->fleet), UnixMs(record.received_at), entry,
                     fault.unix_time_ms, NumberOf(fault.severity), View(fault.category),
                     View(fault.description), View(fault.suggested_action));
}

}  // namespace uplink::storage::sqlite
