#pragma once

#include <mutex>

#include <absl/status/status.h>

#include "metrics/cells.h"
#include "schema/base/clock.h"

namespace uplink::journal {

/// When work of the journal's own is due, and why it could not be done last though the store was
/// there.
///
/// Thread: confined to the writer; error(): any thread.
class Duty final {
 public:
  /// Of a duty that this journal does not have.
  static constexpr SteadyTime kNever = SteadyTime::max();

  /// `failing`, where given, counts the journals in which the duty has an error.
  explicit Duty(SteadyTime due, metrics::Cell* failing = nullptr) : due_(due), failing_(failing) {}

  [[nodiscard]] bool IsDue(SteadyTime now) const { return now >= due_; }
  [[nodiscard]] SteadyTime due() const { return due_; }
  void DueAt(SteadyTime due) { due_ = due; }

  /// What came of it; OK after a success.
  void NoteError(const absl::Status& status);
  [[nodiscard]] absl::Status error() const;

 private:
  SteadyTime due_;
  metrics::Cell* const failing_;
  mutable std::mutex mutex_;
  absl::Status error_;
};

}  // namespace uplink::journal
