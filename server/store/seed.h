#pragma once

#include <atomic>
#include <cstddef>

#include <absl/status/status.h>

#include "schema/base/clock.h"
#include "server/fleet/fleet.h"
#include "server/journal/shards.h"
#include "storage/reader.h"

namespace uplink::store {

/// Takes the robots that the store knows into the fleet, each with its last session as the store
/// has it and with the live state of its last checkpoint: at the start, or as soon as the store can
/// be reached. A robot that has come by itself in the meantime stays as it is; only what it has not
/// told yet is filled in.
///
/// Thread: Run by one thread at a time.
class Seed final {
 public:
  Seed(fleet::Fleet& fleet, const journal::Shards& journals, storage::Reader& reader,
       const Clock& clock)
      : fleet_(fleet), journals_(journals), reader_(reader), clock_(clock) {}

  /// Errors: of the reader, and then it may be run again; kResourceExhausted if the store knows
  ///         more robots than `robots_max`.
  [[nodiscard]] absl::Status Run(std::size_t robots_max);
  [[nodiscard]] bool done() const { return done_.load(); }
  /// Messages of checkpoints that this version does not pass, in the last run. After Run, on its
  /// thread.
  [[nodiscard]] std::size_t live_left_out() const { return live_left_out_; }

 private:
  void RestoreSession(const storage::RobotRow& row);
  [[nodiscard]] absl::Status RestoreLive();
  [[nodiscard]] absl::Status RestoreReported();

  fleet::Fleet& fleet_;
  const journal::Shards& journals_;
  storage::Reader& reader_;
  const Clock& clock_;
  std::size_t live_left_out_ = 0;
  std::atomic<bool> done_{false};
};

}  // namespace uplink::store
