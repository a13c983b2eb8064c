#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "server/fleet/checkpoint.h"
#include "server/fleet/fleet.h"
#include "server/journal/events.h"
#include "server/journal/shards.h"
#include "server/journal/writer.h"
#include "server/log/logger.h"
#include "server/log/rate_limited.h"
#include "storage/identity.h"

namespace uplink::storage {
class Store;
}

namespace uplink::store {

/// The journals before the store, one per connection that writes, each with its share of the
/// bounds, its writer and its checkpoints.
///
/// Thread: constructed, started and stopped by main; journals() from any.
class Writers final {
 public:
  /// The references outlive it.
  struct Context {
    const Clock& clock;
    metrics::LedgerBook& ledgers;
    journal::JournalProbe& probe;
    fleet::Fleet& fleet;
    storage::ProcessId process{};
    /// Evenly drawn, for the backoff's jitter; called by one thread at a time.
    std::function<std::uint64_t()> random;
    /// For all journals together.
    journal::JournalLimits limits;
    /// journal::Journal::OnSpatial.
    std::function<void()> spatial_committed = [] {};
    /// journal::Journal::OnReconnected, after the fleet was told.
    std::function<void()> store_reconnected = [] {};
    /// How often live states are checkpointed; zero: never.
    milliseconds checkpoint_every{0};
    /// journal::Journal::EndConnections, for the journal with the duties; empty: none does it.
    journal::IsOver is_over{};
    /// Writes `robot_moved` and `connection_dropped`, and `commit_slow` at level debug. Null: no
    /// such lines.
    const log::Logger* logger = nullptr;
    /// Called for each robot that moved to another fleet, on a writer's thread: short.
    std::function<void(const journal::Moved&)> moved = [](const journal::Moved& /*moved*/) {};
  };
  /// At least one store; they outlive it.
  Writers(std::span<const std::unique_ptr<storage::Store>> stores, Context context);
  Writers(const Writers&) = delete;
  Writers& operator=(const Writers&) = delete;

  [[nodiscard]] const journal::Shards& journals() const { return shards_; }

  /// Starts a writer per journal.
  void Start();
  /// Ends the writers once their calls of the store have returned. Idempotent.
  void Stop();

 private:
  std::uint64_t Random();

  const Context context_;
  /// Writes `robot_moved` for all journals. Null without a logger; outlives the journals.
  std::unique_ptr<log::RateLimited> moves_;
  /// The same of `connection_dropped`.
  std::unique_ptr<log::RateLimited> drops_;
  const std::vector<std::unique_ptr<journal::Journal>> journals_;
  const journal::Shards shards_;
  /// One per journal, if there are checkpoints.
  std::vector<std::unique_ptr<fleet::Checkpoint>> checkpoints_;
  std::mutex random_mutex_;
  std::vector<std::unique_ptr<journal::JournalWriter>> writers_;
};

}  // namespace uplink::store
