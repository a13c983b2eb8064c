#pragma once

#include <mutex>

#include <absl/status/status.h>

#include "metrics/cells.h"
#include "schema/base/clock.h"

namespace uplink::journal {

/// When one of the journal's own duties is due. Confined to the writer.
class Duty final {
 public:
  /// For a duty that this journal does not have.
  static constexpr SteadyTime kNever = SteadyTime::max();

  explicit Duty(SteadyTime due) : due_(due) {}

  [[nodiscard]] bool IsDue(SteadyTime now) const { return now >= due_; }
  [[nodiscard]] SteadyTime due() const { return due_; }
  void DueAt(SteadyTime due) { due_ = due; }

 private:
  SteadyTime due_;
};

/// Why one of the journal's own duties failed last, although the store is there.
///
/// Thread: thread-safe: the writer notes it, any thread reads it.
class DutyError final {
 public:
  /// `failing` counts the journals in which the duty has an error.
  explicit DutyError(metrics::Cell& failing) : failing_(failing) {}

  /// Notes the duty's result; OK after a success.
  void Note(const absl::Status& status);
  [[nodiscard]] absl::Status last() const;

 private:
  metrics::Cell& failing_;
  mutable std::mutex mutex_;
  absl::Status error_;
};

}  // namespace uplink::journal
