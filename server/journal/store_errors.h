#pragma once

#include <mutex>

#include <absl/status/status.h>

#include "server/journal/probe.h"

namespace uplink::journal {

/// The store's last error in calls that robots wait for, and in duties. The probe counts this
/// journal once among those whose store fails.
///
/// Thread: thread-safe.
class StoreErrors final {
 public:
  explicit StoreErrors(JournalProbe& probe) : probe_(probe) {}

  /// Notes the result of a call that robots wait for. A success shows that the store is there.
  void NoteCall(const absl::Status& status);
  /// Notes the result of a duty's call. A success says nothing about failing commits.
  void NoteDuty(const absl::Status& status);
  /// Notes the result of a comparison after a new connection to the store. A success says nothing
  /// about the call that broke the connection, which is tried again.
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
