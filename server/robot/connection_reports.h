#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <random>
#include <string>

#include "schema/base/clock.h"
#include "server/log/logger.h"
#include "server/robot/connection_sink.h"
#include "server/robot/robot.h"
#include "storage/connection.h"

namespace uplink::robot {

/// How often what an open connection brought is kept: a row of the store per connection and time.
/// It is what a server that crashes leaves of it.
inline constexpr std::chrono::minutes kConnectionUpdateEvery{5};

/// Reports robots' connections of every source as they begin and end: to the robot's state, to the
/// log, and to what keeps them.
///
/// Thread: thread-safe.
class ConnectionReports final {
 public:
  /// The references outlive it.
  struct Context {
    const Clock& clock;
    const log::Logger& logger;
    /// Null: nothing keeps them.
    ConnectionSink* sink = nullptr;
    storage::ProcessId process{};
    /// For drawing ids.
    std::uint64_t seed = 0;
  };
  explicit ConnectionReports(const Context& context) : context_(context), random_(context.seed) {}
  ConnectionReports(const ConnectionReports&) = delete;
  ConnectionReports& operator=(const ConnectionReports&) = delete;

  /// Host and port of this server's relay, once they are known.
  void SetServer(std::string server);
  /// A connection has begun. Its id, process and server are set here; returns the id, by which its
  /// end is reported.
  [[nodiscard]] storage::ConnectionId Begin(Robot& robot, storage::ConnectionItem item);
  /// It goes on: `item.id` is what Begin returned. For a call each kConnectionUpdateEvery; no line.
  void Update(storage::ConnectionItem item);
  /// It has ended: `item.id` is what Begin returned, and `item.ended` is set.
  void End(Robot& robot, storage::ConnectionItem item);

 private:
  [[nodiscard]] storage::ConnectionId DrawId();
  void Complete(storage::ConnectionItem& item) const;

  const Context context_;
  mutable std::mutex mutex_;
  std::mt19937_64 random_;
  std::string server_;
};

}  // namespace uplink::robot
