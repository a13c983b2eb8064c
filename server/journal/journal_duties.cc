// What the journal does besides what waits in it: the sweep, the keeping of histories, checkpoints.
#include <algorithm>

#include "server/journal/journal.h"

namespace uplink::journal {

std::optional<Journal::Step> Journal::AdvanceDuty() {
  const SteadyTime now = clock_.Steady();
  const bool sweeps = limits_.sweeps && now >= sweep_due_;
  if (!sweeps && !(limits_.retains && now >= retain_due_)) return std::nullopt;
  after_duty_ = true;
  return sweeps ? AdvanceSweep() : AdvanceRetain();
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

std::optional<Journal::Step> Journal::AdvanceCheckpoint() {
  const bool due =
      checkpoint_under_way_ || clock_.Steady() >= checkpoint_due_ || checkpoint_asked_.load();
  if (live_ == nullptr || !due) return std::nullopt;
  if (!checkpoint_under_way_) {
    checkpoint_under_way_ = true;
    checkpoint_answers_ = checkpoint_asked_.exchange(false);
    checkpoint_began_ = clock_.Steady();
    live_->BeginRound();
  }
  return WriteCheckpoint();
}

Journal::Step Journal::WriteCheckpoint() {
  const std::vector<storage::LiveRow> rows = live_->TakeChanged(checkpoint_rows_now_);
  if (rows.empty()) {
    EndCheckpoint();
    return Step::kWorked;
  }
  const auto passed_over = store_.Checkpoint(rows);
  if (passed_over.ok()) {
    NoteDuty(absl::OkStatus());
    NoteCheckpoint(absl::OkStatus());
    for (const std::size_t row : *passed_over) live_->PassedOver(rows[row]);
    probe_.checkpoint_robots.Add(static_cast<std::int64_t>(rows.size() - passed_over->size()));
    checkpoint_rows_now_ = std::min(storage::kCheckpointRowsMax, 2 * checkpoint_rows_now_);
    return Step::kWorked;
  }
  live_->PutBack(rows);
  checkpoint_rows_now_ = std::max<std::size_t>(checkpoint_rows_now_ / 2, 1);
  if (absl::IsInternal(passed_over.status())) {
    // Its own trouble, and maybe that of one row: the round goes on behind these.
    NoteCheckpoint(passed_over.status());
    return Step::kWorked;
  }
  // One that was asked for goes on until the store is there, or nobody waits for it any more.
  if (checkpoint_answers_) checkpoint_asked_.store(true);
  EndCheckpoint();
  NoteDuty(passed_over.status());
  return Step::kFailed;
}

void Journal::EndCheckpoint() {
  probe_.checkpoint_seconds.ObserveSince(checkpoint_began_, clock_.Steady());
  checkpoint_under_way_ = false;
  checkpoint_due_ = clock_.Steady() + checkpoint_every_;
  checkpoint_answers_ = false;
  const std::lock_guard lock(mutex_);
  checkpoint_waiting_.store(checkpoint_asked_.load());
}

void Journal::CheckpointFrom(fleet::LiveSource& live, milliseconds every) {
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
