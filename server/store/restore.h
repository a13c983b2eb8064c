#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "server/fleet/fleet.h"
#include "storage/reader.h"

namespace uplink::store {

/// Robots that are restored at a time.
inline constexpr std::size_t kRestoredAtOnceMax = 500;

/// Restores robots that this process has begun to hold from what their last holder stored: live
/// state, and durable reports for their series. What this process has heard meanwhile is newer and
/// stays.
///
/// Thread: due: any; Run by one thread at a time.
class Restore final {
 public:
  /// Both outlive it.
  Restore(const fleet::Fleet& fleet, storage::Reader& reader) : fleet_(fleet), reader_(reader) {}

  /// A robot must be restored.
  [[nodiscard]] bool due() const;
  /// Restores all that are due. Errors: of the reader, and then it may be run again.
  [[nodiscard]] absl::Status Run();
  /// Checkpoint messages of the last run that this version does not accept. On Run's thread.
  [[nodiscard]] std::size_t left_out() const { return left_out_; }

 private:
  [[nodiscard]] std::vector<fleet::RobotPtr> Due() const;
  /// Restores the first of `robots`; returns how many.
  absl::StatusOr<std::size_t> RestoreFirst(std::span<const fleet::RobotPtr> robots);

  const fleet::Fleet& fleet_;
  storage::Reader& reader_;
  std::size_t left_out_ = 0;
};

}  // namespace uplink::store
