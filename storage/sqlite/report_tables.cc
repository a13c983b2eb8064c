#include <string>

#include "schema/json/text.h"
#include "storage/numbers.h"
#include "storage/sqlite/kind_tables.h"
#include "storage/sqlite/prepare.h"
#include "storage/sqlite/values.h"

// What robots report once and what is kept as it came: events, messages, mission reports, the
// latest of some kinds, and changes of presence.
namespace uplink::storage::sqlite {

absl::Status HistoryTables::Prepare(Database& database) {
  Preparer prepare(database);
  prepare.Into(insert_event_,
               "INSERT INTO events (ruri, received_ms, entry, fleet, session, seq, sampled_ms,"
               " kind, detail) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)");
  prepare.Into(insert_message_,
               "INSERT INTO messages (ruri, received_ms, entry, fleet, session, seq, sampled_ms,"
               " level, message) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)");
  return prepare.status();
}

absl::Status HistoryTables::Insert(const CommitRecord& record, const model::EventTelemetry& event,
                                   EntryNumber entry) {
  const std::string detail = json::DetailText(event.kind);
  return insert_event_->Run(View(record.robot->ruri), UnixMs(record.received_at), entry,
                            View(record.robot->fleet), Blob{record.session.AsBytes()}, record.seq,
                            event.unix_time_ms, model::EventKindText(event.kind), View(detail));
}

absl::Status HistoryTables::Insert(const CommitRecord& record, const model::Message& message,
                                   EntryNumber entry) {
  return insert_message_->Run(View(record.robot->ruri), UnixMs(record.received_at), entry,
                              View(record.robot->fleet), Blob{record.session.AsBytes()}, record.seq,
                              message.unix_time_ms, NumberOf(message.level), View(message.message));
}

absl::Status MissionTables::Prepare(Database& database) {
  Preparer prepare(database);
  prepare.Into(insert_report_,
               "INSERT INTO mission_reports (ruri, received_ms, entry, fleet, session, seq,"
               " mission_id, run_id, status, report) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  // A report without a name leaves the last one that a report gave.
  prepare.Into(
      upsert_run_,
      "INSERT INTO mission_runs (ruri, mission_id, run_id, fleet, first_ms, entry, last_ms,"
      " name, status, updates, latest) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?5,"
      " iif(?7, ?8, ''), ?9, 1, ?10)"
      " ON CONFLICT (ruri, mission_id, run_id) DO UPDATE SET fleet = excluded.fleet,"
      " last_ms = excluded.last_ms, name = iif(?7, ?8, name), status = excluded.status,"
      " updates = updates + 1, latest = excluded.latest");
  return prepare.status();
}

absl::Status MissionTables::Insert(const CommitRecord& record,
                                   const model::MissionRunStatus& report, EntryNumber entry) {
  const std::string text = json::Text(report);
  const std::int64_t received_ms = UnixMs(record.received_at);
  absl::Status status =
      insert_report_->Run(View(record.robot->ruri), received_ms, entry, View(record.robot->fleet),
                          Blob{record.session.AsBytes()}, record.seq, View(report.mission_id),
                          View(report.run_id), NumberOf(report.status), View(text));
  if (!status.ok()) return status;
  const std::int64_t named = report.name ? 1 : 0;
  return upsert_run_->Run(View(record.robot->ruri), View(report.mission_id), View(report.run_id),
                          View(record.robot->fleet), received_ms, entry, named,
                          report.name ? View(*report.name) : std::string_view(),
                          NumberOf(report.status), View(text));
}

absl::Status LatestTable::Prepare(Database& database) {
  Preparer prepare(database);
  prepare.Into(upsert_,
               "INSERT INTO latest (ruri, kind, fleet, received_ms, body) VALUES (?, ?, ?, ?, ?)"
               " ON CONFLICT (ruri, kind) DO UPDATE SET fleet = excluded.fleet,"
               " received_ms = excluded.received_ms, body = excluded.body");
  return prepare.status();
}

absl::Status LatestTable::Upsert(const CommitRecord& record, LatestKind kind,
                                 const std::string& body_json) {
  return upsert_->Run(View(record.robot->ruri), static_cast<std::int64_t>(kind),
                      View(record.robot->fleet), UnixMs(record.received_at), View(body_json));
}

absl::Status PresenceTable::Prepare(Database& database) {
  Preparer prepare(database);
  prepare.Into(insert_,
               "INSERT INTO presence_changes (ruri, at_ms, entry, fleet, presence)"
               " VALUES (?, ?, ?, ?, ?)");
  prepare.Into(upsert_latest_,
               "INSERT INTO presence_latest (ruri, presence, at_ms) VALUES (?, ?, ?)"
               " ON CONFLICT (ruri) DO UPDATE SET presence = excluded.presence,"
               " at_ms = excluded.at_ms WHERE at_ms <= excluded.at_ms");
  return prepare.status();
}

absl::Status PresenceTable::Insert(const PresenceItem& item, EntryNumber entry) {
  const auto presence = static_cast<std::int64_t>(item.presence);
  absl::Status status = insert_->Run(View(item.robot->ruri), UnixMs(item.at), entry,
                                     View(item.robot->fleet), presence);
  if (!status.ok()) return status;
  return upsert_latest_->Run(View(item.robot->ruri), presence, UnixMs(item.at));
}

}  // namespace uplink::storage::sqlite
