#pragma once

#include <mutex>

#include <absl/status/status.h>

#include "server/journal/probe.h"

namespace uplink::journal {

/// The error with which the store answered last, of store calls that robots wait for and of duties.
/// In the probe, this journal counts once among those whose store fails.
///
/// Thread: thread-safe.
class StoreErrors final {
 public:
  explicit StoreErrors(JournalProbe& probe) : probe_(probe) {}

  /// The end of a call that robots wait for. One that works shows that the store is there.
  void NoteCall(const absl::Status& status);
  /// The end of a duty's call. That it works says nothing of commits that fail.
  void NoteDuty(const absl::Status& status);
  /// The end of a comparison after the store was connected to anew. One that works says nothing of
  /// the call that broke the connection: that is tried again.
  void NoteCompare(const absl::Status& status);
  /// OK after a success.
  [[nodiscard]] absl::Status last() const;

 private:
  void Set(absl::Status call, absl::Status duty);

  JournalProbe& probe_;
  mutable std::mutex mutex_;
  absl::Status call_;
  absl::Status duty_;
};

}  // namespace uplink::journal
