#include "storage/sqlite/batch_commit.h"

#include <algorithm>
#include <string>
#include <utility>
#include <variant>

#include "storage/bounds.h"
#include "storage/open_run.h"
#include "storage/refusal.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/store_files.h"
#include "storage/sqlite/tables.h"

namespace uplink::storage::sqlite {

absl::StatusOr<std::vector<Outcome>> BatchCommit::Write(const Batch& batch) {
  const absl::StatusOr<EntryNumber> next = tables_.deciding.NextEntry();
  if (!next.ok()) return next.status();
  absl::Status went_back = files_.CheckEntry(*next);
  if (!went_back.ok()) return went_back;
  next_entry_ = *next;
  std::vector<Outcome> outcomes;
  outcomes.reserve(batch.records.size() + batch.presence.size());
  for (const CommitRecord& record : batch.records) {
    absl::StatusOr<Outcome> outcome = WriteOne(record);
    if (!outcome.ok()) return outcome.status();
    outcomes.push_back(*std::move(outcome));
  }
  for (const GapItem& gap : batch.gaps) {
    absl::Status written = WriteGap(gap);
    if (!written.ok()) return written;
  }
  for (const ConnectionItem& item : batch.connections) {
    absl::Status written = WriteConnection(item);
    if (!written.ok()) return written;
  }
  const absl::StatusOr<DeliveryChanges> remembered = decider_.Remember(batch, outcomes);
  if (!remembered.ok()) return remembered.status();
  absl::Status finished = tables_.deciding.Remember(*remembered);
  if (finished.ok()) finished = WritePresence(batch, outcomes);
  if (finished.ok()) finished = Finish();
  if (!finished.ok()) return finished;
  if (next_entry_ != *next) {
    absl::Status counted = tables_.deciding.SetNextEntry(next_entry_);
    if (!counted.ok()) return counted;
  }
  return outcomes;
}

absl::StatusOr<Outcome> BatchCommit::WriteOne(const CommitRecord& record) {
  absl::StatusOr<std::optional<Outcome>> earlier = decider_.Look(record);
  if (!earlier.ok()) return earlier.status();
  if (earlier->has_value()) return **std::move(earlier);

  if (const auto* item = std::get_if<QuarantineItem>(&record.content)) {
    absl::Status written = WriteRejection(record, item->rejection);
    if (!written.ok()) return written;
    return Outcome{};
  }
  if (const auto* range = std::get_if<LimitedRange>(&record.content)) {
    absl::Status kept = tables_.rows.Write<kKeptRejectsTable>({&record, range, next_entry_++});
    if (!kept.ok()) return kept;
    return Outcome{};
  }
  absl::StatusOr<Refusal> refusal =
      isolation_ == Isolation::kTogether ? WriteRecord(record) : WriteAlone(record);
  if (!refusal.ok()) return refusal.status();
  if (!refusal->has_value()) return Outcome{};
  absl::Status written = WriteRejection(record, **refusal);
  if (!written.ok()) return written;
  return Outcome{OutcomeKind::kRefused, *std::move(refusal)};
}

absl::StatusOr<BatchCommit::Refusal> BatchCommit::WriteRecord(const CommitRecord& record) {
  absl::StatusOr<Ruling> ruling = decider_.Judge(record);
  if (!ruling.ok()) return ruling.status();
  if (ruling->refusal) return std::move(ruling->refusal);
  absl::Status written = writer_.Write(record, *ruling);
  if (!written.ok()) return written;
  if (LeavesRunOpen(record)) {
    std::optional<SystemTime>& reported = known_.robot(record.robot->ruri).run_reported;
    reported = std::max(reported.value_or(record.received_at), record.received_at);
  }
  return Refusal();
}

absl::StatusOr<BatchCommit::Refusal> BatchCommit::WriteAlone(const CommitRecord& record) {
  absl::Status status = database_.Execute("SAVEPOINT one");
  if (!status.ok()) return status;
  absl::StatusOr<Refusal> refusal = WriteRecord(record);
  if (absl::IsInvalidArgument(refusal.status())) {
    const absl::string_view cause = refusal.status().message();
    refusal = Refusal(StoreRefused({cause.data(), cause.size()}));
    status = database_.Execute("ROLLBACK TO one; RELEASE one");
    // What the record had changed is counted anew.
    KnownRobot& robot = known_.robot(record.robot->ruri).known;
    robot.counts = {};
    robot.open_requests.reset();
  } else if (refusal.ok()) {
    status = database_.Execute("RELEASE one");
  }
  if (!status.ok()) return status;
  return refusal;
}

absl::Status BatchCommit::WriteRejection(const CommitRecord& record,
                                         const model::Rejection& rejection) {
  if (!record.payload.empty()) known_.robot(record.robot->ruri).quarantined_payload = true;
  const EntryNumber entry = next_entry_++;
  absl::Status status;
  for (const QuarantineDetail detail :
       {QuarantineDetail::kAll, QuarantineDetail::kWithoutPayload, QuarantineDetail::kBare}) {
    if (detail == QuarantineDetail::kWithoutPayload && record.payload.empty()) continue;
    status = tables_.rows.Write<kQuarantineTable>({&record, rejection, detail, entry});
    if (!absl::IsInvalidArgument(status)) return status;
  }
  return absl::InternalError("quarantine takes not even a bare row: " +
                             std::string(status.message()));
}

absl::Status BatchCommit::WriteGap(const GapItem& gap) {
  const absl::StatusOr<bool> takes = decider_.Takes(gap);
  if (!takes.ok()) return takes.status();
  if (!*takes) return absl::OkStatus();
  known_.robot(gap.robot->ruri).gaps = true;
  return tables_.rows.Write<kGapsTable>({&gap, gap.last, next_entry_++});
}

absl::Status BatchCommit::WriteConnection(const ConnectionItem& item) {
  const absl::StatusOr<KnownRobot*> robot = known_.Robot(item.robot->ruri);
  if (!robot.ok()) return robot.status();
  if (*robot == nullptr) return absl::OkStatus();
  known_.robot(item.robot->ruri).connections = true;
  return tables_.rows.Write<kConnectionsTable>({&item, next_entry_++});
}

absl::Status BatchCommit::WritePresence(const Batch& batch, std::vector<Outcome>& outcomes) {
  if (batch.presence.empty()) return absl::OkStatus();
  const auto stored = tables_.deciding.FindSession(kServerRuri, batch.presence_session);
  if (!stored.ok()) return stored.status();
  const SessionCursor row = stored->value_or(SessionCursor{0, next_entry_});
  KnownSession session;
  session.cursor = row.cursor;
  for (const PresenceItem& item : batch.presence) {
    const absl::StatusOr<OutcomeKind> outcome = decider_.Decide(item, session);
    if (!outcome.ok()) return outcome.status();
    outcomes.push_back({*outcome, std::nullopt});
    if (*outcome != OutcomeKind::kStored) continue;
    const PresenceChange change = {&item, next_entry_++};
    absl::Status written;
    if (item.changes_presence) written = tables_.rows.Write<kPresenceChangesTable>(change);
    if (written.ok()) written = tables_.rows.Write<kLatestPresenceTable>(change);
    if (!written.ok()) return written;
  }
  absl::Status raised =
      tables_.deciding.RaiseCursor(kServerRuri, batch.presence_session,
                                   {session.cursor, row.first_entry}, batch.presence.back().at);
  if (!raised.ok() || stored->has_value()) return raised;
  return TrimServerSessions(batch.presence_session);
}

absl::Status BatchCommit::TrimServerSessions(const model::SessionId& present) {
  DecidingTables& deciding = tables_.deciding;
  const absl::StatusOr<std::vector<model::SessionId>> sessions = deciding.Sessions(kServerRuri);
  if (!sessions.ok()) return sessions.status();
  std::size_t kept = sessions->size();
  for (const model::SessionId& session : *sessions) {
    if (kept <= kServerSessionsMax) break;
    if (session == present) continue;
    absl::Status deleted = deciding.DeleteSession(kServerRuri, session);
    if (!deleted.ok()) return deleted;
    --kept;
  }
  return absl::OkStatus();
}

absl::Status BatchCommit::WriteSamples(std::string_view ruri, const KnownSamples& samples) {
  absl::Status written = tables_.rows.Write<kSamplesTable>({ruri, samples.memory});
  if (!written.ok()) return written;
  return tables_.claims.Use(ruri, samples.stored_at);
}

absl::Status BatchCommit::Finish() {
  for (const auto& [ruri, robot] : known_.robots()) {
    absl::Status status;
    for (const BatchSession& session : robot.sessions) {
      if (!session.known.is_raised || !status.ok()) continue;
      status = tables_.deciding.RaiseCursor(
          ruri, session.id, {session.known.cursor, session.first_entry}, session.known.last_used);
    }
    for (const auto& [type, samples] : robot.samples) {
      if (status.ok() && samples.is_changed) status = WriteSamples(ruri, samples);
    }
    if (status.ok() && robot.quarantined_payload) status = tables_.set_aside.ThinPayloads(ruri);
    if (status.ok() && robot.gaps) status = tables_.set_aside.TrimGaps(ruri);
    if (status.ok() && robot.connections) status = tables_.connections.Trim(ruri);
    if (!status.ok()) return status;
    if (!robot.run_reported) continue;
    const auto closed = tables_.retention.CloseOver(ruri, *robot.run_reported);
    if (!closed.ok()) return closed.status();
    runs_closed_ += *closed;
  }
  return absl::OkStatus();
}

}  // namespace uplink::storage::sqlite
