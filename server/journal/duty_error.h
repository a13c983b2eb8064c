#pragma once

#include <mutex>

#include <absl/status/status.h>

#include "metrics/cells.h"

namespace uplink::journal {

/// Why a duty of the journal's own could not be done last though the store was there.
///
/// Thread: thread-safe: the writer notes it, any thread reads it.
class DutyError final {
 public:
  /// `failing` counts the journals in which the duty has an error.
  explicit DutyError(metrics::Cell& failing) : failing_(failing) {}

  /// What came of the duty; OK after a success.
  void Note(const absl::Status& status);
  [[nodiscard]] absl::Status last() const;

 private:
  metrics::Cell& failing_;
  mutable std::mutex mutex_;
  absl::Status error_;
};

}  // namespace uplink::journal
