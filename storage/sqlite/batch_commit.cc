#include "storage/sqlite/batch_commit.h"

#include <algorithm>
#include <string>
#include <utility>
#include <variant>

#include "schema/base/check.h"
#include "storage/refusal.h"

namespace uplink::storage::sqlite {

using model::Rejection;

absl::StatusOr<std::vector<Outcome>> BatchCommit::Write(const Batch& batch) {
  const absl::StatusOr<EntryNumber> next = tables_.deciding.NextEntry();
  if (!next.ok()) return next.status();
  next_entry_ = *next;
  std::vector<Outcome> outcomes;
  outcomes.reserve(batch.records.size());
  for (const CommitRecord& record : batch.records) {
    absl::StatusOr<Outcome> outcome = WriteOne(record);
    if (!outcome.ok()) return outcome.status();
    outcomes.push_back(*std::move(outcome));
  }
  for (const GapItem& gap : batch.gaps) {
    absl::Status written = WriteGap(gap);
    if (!written.ok()) return written;
  }
  absl::Status finished = WritePresence(batch);
  if (finished.ok()) finished = Finish();
  if (!finished.ok()) return finished;
  if (next_entry_ != *next) {
    absl::Status counted = tables_.deciding.SetNextEntry(next_entry_);
    if (!counted.ok()) return counted;
  }
  return outcomes;
}

absl::StatusOr<BatchCommit::Robot*> BatchCommit::FindRobot(const RobotRef& id, Epoch held_since,
                                                           SystemTime at) {
  const auto known = robots_.find(id->ruri);
  if (known != robots_.end()) return &known->second;
  absl::StatusOr<std::optional<Epoch>> stored = tables_.deciding.HeldSince(id->ruri);
  if (!stored.ok()) return stored.status();
  if (!stored->has_value()) {
    absl::Status inserted = tables_.deciding.InsertRobot(*id, held_since, at, process_);
    if (!inserted.ok()) return inserted;
    *stored = held_since;
  }
  Robot& robot = robots_[id->ruri];
  robot.held_since = **stored;
  return &robot;
}

absl::StatusOr<BatchCommit::Session*> BatchCommit::FindSession(Robot& robot,
                                                               const CommitRecord& record) {
  const auto known = std::ranges::find(robot.sessions, record.session, &Session::id);
  if (known != robot.sessions.end()) return &*known;
  const absl::StatusOr<std::optional<SessionCursor>> stored =
      tables_.deciding.FindSession(record.robot->ruri, record.session);
  if (!stored.ok()) return stored.status();
  robot.sessions.push_back(
      {record.session, stored->value_or(SessionCursor{0, next_entry_}), {}, false});
  return &robot.sessions.back();
}

absl::StatusOr<Outcome> BatchCommit::WriteOne(const CommitRecord& record) {
  UPLINK_CHECK(record.seq <= model::kSeqMax, "a number past the contract's reached the store");
  const absl::StatusOr<Robot*> robot =
      FindRobot(record.robot, record.held_since, record.received_at);
  if (!robot.ok()) return robot.status();
  if (record.held_since < (*robot)->held_since) return Outcome{OutcomeKind::kFenced, std::nullopt};
  const absl::StatusOr<Session*> found = FindSession(**robot, record);
  if (!found.ok()) return found.status();
  Session& session = **found;
  if (record.seq <= session.row.cursor) return Earlier(session, record);

  Outcome outcome;
  if (const auto* item = std::get_if<QuarantineItem>(&record.content)) {
    absl::Status written = WriteRejection(**robot, record, item->rejection);
    if (!written.ok()) return written;
  } else {
    absl::StatusOr<std::optional<Rejection>> refusal = isolation_ == Isolation::kTogether
                                                           ? WriteRecord(**robot, record)
                                                           : WriteAlone(**robot, record);
    if (!refusal.ok()) return refusal.status();
    if (refusal->has_value()) {
      absl::Status written = WriteRejection(**robot, record, **refusal);
      if (!written.ok()) return written;
      outcome = {OutcomeKind::kRefused, *std::move(refusal)};
    }
  }
  session.row.cursor = record.seq;
  session.last_used = std::max(session.last_used, record.received_at);
  session.raised = true;
  return outcome;
}

absl::StatusOr<Outcome> BatchCommit::Earlier(const Session& session, const CommitRecord& record) {
  if (record.seq == 0) return Outcome{OutcomeKind::kDuplicate, std::nullopt};
  RejectRange range;
  range.ruri = record.robot->ruri;
  range.session = record.session;
  range.first_entry = session.row.first_entry;
  range.above = record.seq - 1;
  range.through = record.seq;
  absl::StatusOr<std::vector<StoredReject>> rejects = tables_.set_aside.Rejects(range, 1);
  if (!rejects.ok()) return rejects.status();
  if (rejects->empty()) return Outcome{OutcomeKind::kDuplicate, std::nullopt};
  return Outcome{OutcomeKind::kRefused, std::move(rejects->front().rejection)};
}

absl::StatusOr<std::optional<Rejection>> BatchCommit::WriteAlone(Robot& robot,
                                                                 const CommitRecord& record) {
  absl::Status status = database_.Execute("SAVEPOINT one");
  if (!status.ok()) return status;
  absl::StatusOr<std::optional<Rejection>> refusal = WriteRecord(robot, record);
  if (absl::IsInvalidArgument(refusal.status())) {
    const absl::string_view cause = refusal.status().message();
    refusal = std::optional<Rejection>(StoreRefused({cause.data(), cause.size()}));
    status = database_.Execute("ROLLBACK TO one; RELEASE one");
    // What the record had changed is counted anew.
    robot.shapes.reset();
    robot.objects.reset();
  } else if (refusal.ok()) {
    status = database_.Execute("RELEASE one");
  }
  if (!status.ok()) return status;
  return refusal;
}

absl::StatusOr<std::optional<Rejection>> BatchCommit::WriteFault(Robot& robot,
                                                                 const CommitRecord& record,
                                                                 const model::Fault& fault) {
  const std::string_view ruri = record.robot->ruri;
  const absl::StatusOr<bool> was_active = tables_.faults.IsActive(ruri, fault);
  if (!was_active.ok()) return was_active.status();
  const bool is_new = fault.active && !*was_active;
  if (is_new && !robot.faults_active) {
    const absl::StatusOr<std::size_t> count = tables_.faults.CountActive(ruri);
    if (!count.ok()) return count.status();
    robot.faults_active = *count;
  }
  if (is_new && *robot.faults_active >= kActiveFaultsPerRobotMax) {
    return std::optional<Rejection>(TooManyActiveFaults());
  }
  const EntryNumber entry = next_entry_++;
  absl::Status status = tables_.faults.InsertHistory(record, fault, entry);
  if (status.ok() && fault.active) status = tables_.faults.Raise(record, fault, entry);
  if (status.ok() && !fault.active && *was_active) status = tables_.faults.Clear(ruri, fault);
  if (!status.ok()) return status;
  if (is_new) ++*robot.faults_active;
  if (!fault.active && *was_active && robot.faults_active) --*robot.faults_active;
  return std::optional<Rejection>();
}

absl::Status BatchCommit::WriteRejection(Robot& robot, const CommitRecord& record,
                                         const Rejection& rejection) {
  robot.quarantined_payload = robot.quarantined_payload || !record.payload.empty();
  absl::Status status = tables_.set_aside.Insert(record, rejection, next_entry_++);
  if (!absl::IsInvalidArgument(status)) return status;
  return absl::InternalError("quarantine takes not even a bare row: " +
                             std::string(status.message()));
}

absl::Status BatchCommit::WriteGap(const GapItem& gap) {
  const absl::StatusOr<Robot*> robot = FindRobot(gap.robot, gap.held_since, gap.seen_at);
  if (!robot.ok()) return robot.status();
  if (gap.held_since < (*robot)->held_since) return absl::OkStatus();
  (*robot)->gaps = true;
  return tables_.set_aside.UpsertGap(gap, next_entry_++);
}

absl::Status BatchCommit::Finish() {
  for (const auto& [ruri, robot] : robots_) {
    absl::Status status;
    for (const Session& session : robot.sessions) {
      if (!session.raised || !status.ok()) continue;
      status = tables_.deciding.RaiseCursor(ruri, session.id, session.row, session.last_used);
    }
    if (status.ok() && robot.quarantined_payload) status = tables_.set_aside.ThinPayloads(ruri);
    if (status.ok() && robot.gaps) status = tables_.set_aside.TrimGaps(ruri);
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

}  // namespace uplink::storage::sqlite
