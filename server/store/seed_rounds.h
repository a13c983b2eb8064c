#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

#include <absl/status/status.h>

#include "schema/base/clock.h"
#include "server/fleet/fleet.h"
#include "server/journal/shards.h"
#include "server/log/logger.h"
#include "server/store/seed.h"
#include "storage/reader.h"

namespace uplink::store {

/// Runs the seed at the start, again and again while the store is away, and logs what came of it.
///
/// Thread: Begin on main before the rest; ReadOn on one thread; done from any.
class SeedRounds final {
 public:
  /// The references outlive it.
  struct Context {
    fleet::Fleet& fleet;
    const journal::Shards& journals;
    storage::Reader& reader;
    const Clock& clock;
    log::Logger& logger;
    std::size_t robots_max = 0;
  };
  explicit SeedRounds(const Context& context)
      : context_(context), seed_(context.fleet, context.journals, context.reader, context.clock) {}
  SeedRounds(const SeedRounds&) = delete;
  SeedRounds& operator=(const SeedRounds&) = delete;

  /// Takes the robots that the store knows into the fleet, unless it is away; `away` says why it
  /// is. Errors: of the reader; more robots than there may be.
  [[nodiscard]] absl::Status Begin(absl::Status away);
  /// Reads the robots by a job on a thread that may wait, if they are still to be read and no such
  /// job is under way. `post` is false where it takes no job now.
  void ReadOn(const std::function<bool(std::function<void()>)>& post);
  [[nodiscard]] bool done() const { return seed_.done(); }

 private:
  void Read();
  void LogLiveLeftOut();

  const Context context_;
  Seed seed_;
  std::atomic<bool> reading_{false};
};

}  // namespace uplink::store
