#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include <absl/status/status.h>

#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "server/fleet/checkpoint.h"
#include "server/fleet/fleet.h"
#include "server/journal/shards.h"
#include "server/journal/writer.h"
#include "server/log/logger.h"
#include "server/store/open.h"
#include "server/store/seed.h"

namespace uplink::store {

/// The store with what stands before it: a journal and its writer a shard, the robots that it
/// knows, and what the log says of it.
///
/// Thread: constructed, started and stopped by main; the rest as each says.
class StoreSide final {
 public:
  /// The references outlive it.
  struct Parts {
    const Clock& clock;
    log::Logger& logger;
    metrics::LedgerBook& ledgers;
    journal::JournalProbe& probe;
    fleet::Fleet& fleet;
    storage::ProcessId process{};
    /// Evenly drawn; called by one thread at a time.
    std::function<std::uint64_t()> random;
    /// Of all journals together.
    journal::JournalLimits limits;
    std::size_t robots_max = 0;
    /// How often live states are checkpointed; zero: never.
    milliseconds checkpoint_every{0};
  };
  StoreSide(Stores stores, Parts parts);
  StoreSide(const StoreSide&) = delete;
  StoreSide& operator=(const StoreSide&) = delete;

  [[nodiscard]] const journal::Shards& journals() const { return shards_; }
  [[nodiscard]] storage::Reader& reader() { return *stores_.reader; }
  /// Any thread.
  [[nodiscard]] storage::StoreFacts facts() const { return stores_.facts(); }

  /// Says what was found when the store was opened, and takes the robots that it knows into the
  /// fleet, unless it is away. Errors: of the reader; more robots than there may be.
  [[nodiscard]] absl::Status Begin();
  /// Reads the robots by a job on a thread that may wait, if they are still to be read and no such
  /// job is under way. `post` is false where it takes no job now.
  void ReadRobotsOn(const std::function<bool(std::function<void()>)>& post);
  /// Says once when the store begins to fail and when it works again, and what else is worth a line
  /// of it. One thread.
  void LookForErrors();

  void StartWriters();
  /// Ends the writers, after the calls of the store that are under way. Idempotent.
  void StopWriters();

 private:
  std::vector<std::unique_ptr<journal::Journal>> MakeJournals();
  std::uint64_t Random();
  void LookAtFacts();
  void NoteLiveLeftOut();
  /// The events of something that begins to fail, and that works again.
  struct Turn {
    const char* fails;
    const char* works_again;
  };
  /// Says so once when `status` shows that it changed.
  void NoteTurn(bool& works, const absl::Status& status, const Turn& turn);
  void ReadRobots();

  const Stores stores_;
  const Parts parts_;
  const std::vector<std::unique_ptr<journal::Journal>> journals_;
  const journal::Shards shards_;
  /// One a journal, if there are checkpoints.
  std::vector<std::unique_ptr<fleet::Checkpoint>> checkpoints_;
  Seed seed_;
  std::atomic<bool> reading_{false};
  bool works_ = true;
  bool retains_ = true;
  bool checkpoints_work_ = true;
  bool said_unsafe_ = false;
  bool said_clock_ = false;
  std::mutex random_mutex_;
  std::vector<std::unique_ptr<journal::JournalWriter>> writers_;
};

}  // namespace uplink::store
