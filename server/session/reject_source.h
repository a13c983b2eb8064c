#pragma once

#include <functional>
#include <vector>

#include <absl/status/statusor.h>

#include "storage/rejects.h"

namespace uplink::session {

/// Reads quarantined Rejects where it may take long: away from the streams' threads and from the
/// writers. Thread-safe.
class RejectSource {
 public:
  using Done = std::function<void(absl::StatusOr<std::vector<storage::StoredReject>> rejects)>;

  virtual ~RejectSource() = default;
  /// `done` is called once, on another thread. False, and it is never called, if too many reads
  /// wait.
  [[nodiscard]] virtual bool Read(const storage::RejectsQuery& query, Done done) = 0;
};

}  // namespace uplink::session
