#include "server/journal/checkpoint_rounds.h"

#include <vector>

#include "storage/store.h"

namespace uplink::journal {

CheckpointRounds::CheckpointRounds(const WriterContext& context, Holds& holds)
    : context_(context),
      holds_(holds),
      duty_(Duty::kNever),
      rows_(
          {.most = storage::kCheckpointRowsMax, .failures_to_halve = 1, .successes_to_double = 1}) {
}

void CheckpointRounds::SetSource(fleet::LiveSource& live, milliseconds every) {
  live_ = &live;
  every_ = every;
  duty_.DueAt(context_.clock.Steady() + every);
}

std::optional<Step> CheckpointRounds::Advance() {
  const bool due =
      under_way_ || duty_.IsDue(context_.clock.Steady()) || context_.inbox.checkpoint_asked();
  if (live_ == nullptr || !due) return std::nullopt;
  if (!under_way_) {
    under_way_ = true;
    answers_ = context_.inbox.BeginCheckpoint();
    began_ = context_.clock.Steady();
    live_->BeginRound();
  }
  return WriteRows();
}

Step CheckpointRounds::WriteRows() {
  const std::vector<storage::LiveRow> rows = live_->TakeChanged(rows_.now());
  if (rows.empty()) {
    EndRound();
    return Step::kWorked;
  }
  const auto passed_over = context_.store.Checkpoint(rows);
  if (!passed_over.ok()) {
    live_->PutBack(rows);
    return AfterFailure(passed_over.status());
  }
  context_.errors.NoteDuty(absl::OkStatus());
  context_.checkpoint_error.Note(absl::OkStatus());
  for (const std::size_t row : *passed_over) {
    live_->PassedOver(rows[row]);
    // No other step may notice it: nothing is committed of a robot that sends only live messages.
    holds_.LoseSince(rows[row].ruri, rows[row].held_since).Wake();
  }
  context_.probe.checkpoint_robots.Add(
      static_cast<std::int64_t>(rows.size() - passed_over->size()));
  rows_.Succeeded();
  return Step::kWorked;
}

Step CheckpointRounds::AfterFailure(const absl::Status& status) {
  // Half of the call's maximum: a few large rows are bounded by their bytes already.
  static_cast<void>(rows_.Failed(rows_.now()));
  if (absl::IsInternal(status)) {
    context_.checkpoint_error.Note(status);
    return Step::kWorked;
  }
  // A requested round goes on until the store is there, or it is no longer wanted.
  if (answers_) context_.inbox.RenewCheckpoint();
  EndRound();
  context_.errors.NoteDuty(status);
  return Step::kFailed;
}

void CheckpointRounds::EndRound() {
  context_.probe.checkpoint_seconds.ObserveSince(began_, context_.clock.Steady());
  under_way_ = false;
  duty_.DueAt(context_.clock.Steady() + every_);
  answers_ = false;
  context_.inbox.EndCheckpoint();
}

}  // namespace uplink::journal
