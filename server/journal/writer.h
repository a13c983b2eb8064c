#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>

#include "schema/base/backoff.h"
#include "server/journal/journal.h"
#include "server/loop/rounds.h"

namespace uplink::journal {

/// The thread that drives one journal: commits what gathered, waits when there is nothing, pauses
/// with a growing backoff while the store fails.
///
/// Thread: started and stopped by its owner. Stops in its destructor at the latest, after the call
/// of the store that is under way.
class JournalWriter final {
 public:
  /// `random` draws evenly; it is called on the writer's thread alone.
  JournalWriter(Journal& journal, const BackoffLimits& backoff,
                std::function<std::uint64_t()> random);
  JournalWriter(const JournalWriter&) = delete;
  JournalWriter& operator=(const JournalWriter&) = delete;

  /// Asks the thread to end, without waiting for it.
  void RequestStop() { rounds_.RequestStop(); }
  /// Ends the thread; what is not committed stays in the journal. Idempotent.
  void Stop() { rounds_.Stop(); }

 private:
  loop::Next Round(const std::stop_token& stop);

  Turns& turns_;
  Backoff backoff_;
  const std::function<std::uint64_t()> random_;
  loop::Rounds rounds_;
};

}  // namespace uplink::journal
