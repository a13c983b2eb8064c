#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include <absl/status/status.h>

#include "schema/base/clock.h"
#include "server/fleet/fleet.h"
#include "server/journal/shards.h"
#include "server/log/logger.h"
#include "server/loop/one_at_a_time.h"
#include "server/store/restore.h"
#include "server/store/robot_loader.h"
#include "storage/reader.h"

namespace uplink::store {

/// Loads the robots at the start, and repeatedly while the store is away; restores robots that this
/// process has begun to hold. Logs the results.
///
/// Thread: Begin on main before the rest; ReadOn on one thread; done from any.
class RobotLoadRounds final {
 public:
  /// The references outlive it.
  struct Context {
    fleet::Fleet& fleet;
    const journal::Shards& journals;
    storage::Reader& reader;
    log::Logger& logger;
    std::size_t robots_max = 0;
    /// RobotLoader::Context's.
    std::optional<milliseconds> adopt_grace;
    /// RobotLoader::Context's.
    std::function<bool(SystemTime heard_at)> is_forgotten = [](SystemTime) { return false; };
  };
  explicit RobotLoadRounds(const Context& context)
      : context_(context),
        loader_({context.fleet, context.journals, context.reader, context.adopt_grace,
                 context.is_forgotten}),
        restore_(context.fleet, context.reader) {}
  RobotLoadRounds(const RobotLoadRounds&) = delete;
  RobotLoadRounds& operator=(const RobotLoadRounds&) = delete;

  /// Takes the robots that the store knows into the fleet, unless the store is away; `away` says
  /// why. ReadOn then reads the rest.
  void Begin(const absl::Status& away);
  /// Reads the robots, or restores those that are ours, on a thread that may wait; only if there is
  /// something to read and no such job is under way.
  void ReadOn(const loop::Post& post);
  /// The robots were read. Until then the log says why not.
  [[nodiscard]] bool done() const { return loader_.done(); }

 private:
  void Read();
  void LogLeftOut(std::size_t robots);
  void LogUnread(const absl::Status& why);
  void RestoreDue();

  const Context context_;
  RobotLoader loader_;
  Restore restore_;
  loop::OneAtATime reads_;
  /// The last result; on main, then on the thread of the jobs.
  absl::Status unread_;
  bool restores_ = true;
};

}  // namespace uplink::store
