// What the journal does besides what waits in it: the sweep, the keeping of histories, checkpoints.
#include "server/journal/journal.h"

namespace uplink::journal {

std::optional<Journal::Step> Journal::AdvanceDuty() {
  const SteadyTime now = clock_.Steady();
  after_duty_ = true;
  if (limits_.sweeps && now >= sweep_due_) return AdvanceSweep();
  if (limits_.retains && now >= retain_due_) return AdvanceRetain();
  const bool checkpoints =
      checkpoint_under_way_ || now >= checkpoint_due_ || checkpoint_asked_.load();
  if (live_ != nullptr && checkpoints) return AdvanceCheckpoint();
  after_duty_ = false;
  return std::nullopt;
}

Journal::Step Journal::AdvanceSweep() {
  const auto deleted = store_.Sweep(clock_.System());
  NoteDuty(deleted.status());
  const bool more = deleted.ok() && *deleted >= storage::kSweepRowsMax;
  sweep_due_ = clock_.Steady() + (more ? kSweepAgain : kSweepInterval);
  if (!deleted.ok()) return Step::kFailed;
  probe_.expired_deleted.Add(static_cast<std::int64_t>(*deleted));
  return Step::kWorked;
}

Journal::Step Journal::AdvanceRetain() {
  const auto deleted = store_.Retain(clock_.System());
  const SteadyTime now = clock_.Steady();
  if (absl::IsUnavailable(deleted.status())) {
    NoteDuty(deleted.status());
    retain_due_ = now + kRetainAgain;
    return Step::kFailed;
  }
  probe_.retention_failing.Set(deleted.ok() ? 0 : 1);
  {
    const std::lock_guard lock(mutex_);
    retain_error_ = deleted.status();
  }
  // Commits go on as if nothing was: it is no trouble of theirs.
  if (!deleted.ok()) {
    retain_due_ = now + kRetainLater;
    return Step::kWorked;
  }
  NoteDuty(absl::OkStatus());
  probe_.history_deleted.Add(static_cast<std::int64_t>(*deleted));
  retain_due_ = now;
  if (*deleted >= storage::kRetainRowsMax) {
    retain_due_ += kSweepAgain;
  } else {
    retain_due_ += kRetainInterval;
  }
  return Step::kWorked;
}

Journal::Step Journal::AdvanceCheckpoint() {
  if (!checkpoint_under_way_) {
    checkpoint_under_way_ = true;
    checkpoint_answers_ = checkpoint_asked_.exchange(false);
  }
  const std::vector<storage::LiveRow> rows = live_->TakeChanged();
  if (rows.empty()) {
    EndCheckpoint();
    return Step::kWorked;
  }
  const auto written = store_.Checkpoint(rows);
  if (written.ok()) {
    NoteDuty(absl::OkStatus());
    NoteCheckpoint(absl::OkStatus());
    probe_.checkpoint_robots.Add(static_cast<std::int64_t>(*written));
    return Step::kWorked;
  }
  live_->PutBack(rows);
  // One that was asked for goes on until the store is there, or nobody waits for it any more.
  const bool away = !absl::IsInternal(written.status());
  if (away && checkpoint_answers_) checkpoint_asked_.store(true);
  EndCheckpoint();
  if (away) {
    NoteDuty(written.status());
    return Step::kFailed;
  }
  NoteCheckpoint(written.status());
  return Step::kWorked;
}

void Journal::EndCheckpoint() {
  checkpoint_under_way_ = false;
  checkpoint_due_ = clock_.Steady() + checkpoint_every_;
  checkpoint_answers_ = false;
  checkpoint_waiting_.store(checkpoint_asked_.load());
}

void Journal::CheckpointFrom(LiveSource& live, milliseconds every) {
  live_ = &live;
  checkpoint_every_ = every;
  checkpoint_due_ = clock_.Steady() + every;
}

void Journal::RequestCheckpoint() {
  if (live_ == nullptr) return;
  {
    const std::lock_guard lock(mutex_);
    checkpoint_waiting_.store(true);
    checkpoint_asked_.store(true);
  }
  work_.notify_one();
}

absl::Status Journal::checkpoint_error() const {
  const std::lock_guard lock(mutex_);
  return checkpoint_error_;
}

void Journal::NoteCheckpoint(const absl::Status& status) {
  const std::lock_guard lock(mutex_);
  if (checkpoint_error_.ok() != status.ok()) probe_.checkpoint_failing.Add(status.ok() ? -1 : 1);
  checkpoint_error_ = status;
}

}  // namespace uplink::journal
