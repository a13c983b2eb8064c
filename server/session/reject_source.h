#pragma once

#include <functional>
#include <vector>

#include <absl/status/statusor.h>

#include "storage/rejects.h"

namespace uplink::session {

/// Reads quarantined Rejects on a thread that may take long, apart from the streams' threads and
/// the writers. Thread-safe.
class RejectSource {
 public:
  using Done = std::function<void(absl::StatusOr<std::vector<storage::StoredReject>> rejects)>;

  virtual ~RejectSource() = default;
  /// Calls `done` once, on another thread. False, without a call, if too many reads wait.
  [[nodiscard]] virtual bool Read(const storage::RejectsQuery& query, Done done) = 0;
};

}  // namespace uplink::session
