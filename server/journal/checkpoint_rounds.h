#pragma once

#include <optional>

#include "schema/base/clock.h"
#include "server/fleet/live_source.h"
#include "server/journal/call_size.h"
#include "server/journal/duty.h"
#include "server/journal/holds.h"
#include "server/journal/writer_context.h"

namespace uplink::journal {

/// Writes changed live states to the store, in rounds of many calls. A round begins when it is due
/// or was requested, and ends when the source has no more rows.
///
/// A robot that the store skips is no longer held.
///
/// Errors:  kInternal is the checkpoint's own error, perhaps of one row: the rows go back to their
///          source, and the round goes on. Any other is the store's: the round ends, and a
///          requested one begins again.
/// Thread:  confined to the writer.
class CheckpointRounds final {
 public:
  /// All outlive it.
  CheckpointRounds(const WriterContext& context, Holds& holds);

  /// Sets the live states to write each `every`, before the first Advance. `live` outlives this;
  /// without it no round is due.
  void SetSource(fleet::LiveSource& live, milliseconds every);

  [[nodiscard]] const Duty& duty() const { return duty_; }
  /// Writes the next rows of the round. Empty if no round is under way and none is due.
  [[nodiscard]] std::optional<Step> Advance();

 private:
  Step WriteRows();
  Step AfterFailure(const absl::Status& status);
  void EndRound();

  const WriterContext context_;
  Holds& holds_;
  Duty duty_;
  CallSize rows_;
  fleet::LiveSource* live_ = nullptr;
  milliseconds every_{0};
  SteadyTime began_;
  bool under_way_ = false;
  /// The round under way was requested.
  bool answers_ = false;
};

}  // namespace uplink::journal
