#pragma once

#include <cstddef>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "schema/base/clock.h"
#include "server/journal/probe.h"

namespace uplink::journal {

/// Robots that one line of the log names (`store_went_back`).
inline constexpr std::size_t kWentBackNamed = 8;

/// The robots of one shard for which the store had less than it had confirmed. A value.
struct WentBack {
  std::size_t shard = 0;
  std::size_t robots = 0;
  /// The first of them, kWentBackNamed at most.
  std::vector<std::string> named;
};

/// Counts robots for which a journal's store has less than it confirmed, and keeps the first names
/// for the log. Thread-safe.
class WentBackNotes final {
 public:
  explicit WentBackNotes(JournalProbe& probe) : probe_(probe) {}

  void Note(const std::string& ruri, SteadyTime now) {
    probe_.NoteWentBack(now);
    const std::lock_guard lock(mutex_);
    ++noted_.robots;
    if (noted_.named.size() < kWentBackNamed) noted_.named.push_back(ruri);
  }
  /// Robots noted since the last call.
  [[nodiscard]] WentBack Take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(noted_, {});
  }

 private:
  JournalProbe& probe_;
  std::mutex mutex_;
  WentBack noted_;
};

}  // namespace uplink::journal
