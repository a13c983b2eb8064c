#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>

#include "schema/base/backoff.h"
#include "server/journal/journal.h"
#include "server/loop/rounds.h"

namespace uplink::journal {

/// The thread that drives one journal: it commits entries, waits while there are none, and pauses
/// with a growing backoff while the store fails.
///
/// Thread: started and stopped by its owner. The destructor stops it at the latest, once the store
///         call under way has returned.
class JournalWriter final {
 public:
  /// `random` draws evenly; it is called on the writer's thread alone.
  JournalWriter(Journal& journal, const BackoffLimits& backoff,
                std::function<std::uint64_t()> random);
  JournalWriter(const JournalWriter&) = delete;
  JournalWriter& operator=(const JournalWriter&) = delete;

  /// Asks the thread to end, and does not wait.
  void RequestStop() { rounds_.RequestStop(); }
  /// Ends the thread; uncommitted entries stay in the journal. Idempotent.
  void Stop() { rounds_.Stop(); }

 private:
  loop::Next Round(const std::stop_token& stop);

  Turns& turns_;
  Backoff backoff_;
  const std::function<std::uint64_t()> random_;
  loop::Rounds rounds_;
};

}  // namespace uplink::journal
