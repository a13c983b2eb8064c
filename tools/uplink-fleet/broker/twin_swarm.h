#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "schema/base/clock.h"
#include "tools/uplink-fleet/broker/link.h"
#include "tools/uplink-fleet/broker/twin_group.h"

namespace uplink::synthetic {

/// Connections to the broker, each with a thread of its own, and twins that share one before there
/// is a second one.
inline constexpr std::size_t kBrokerConnectionsMax = 16;
inline constexpr std::size_t kTwinsPerConnection = 8;

/// What a run with twins publishes. A value.
struct TwinSwarmOptions {
  /// Its version and client id are set per connection.
  BrokerSettings broker;
  std::uint64_t seed = 1;
  std::string run;
  std::string prefix;
  double rate_hz = 20;
  std::size_t twins = 10;
};

/// All twins of a run, spread evenly over connections; every second one speaks MQTT 3.1.1, as the
/// vendor's bridge does.
///
/// Thread: confined to main's; owns those of the groups.
class TwinSwarm final {
 public:
  TwinSwarm(const TwinSwarmOptions& options, const Clock& clock, TwinsShared& shared);
  /// Gives up what still goes on.
  ~TwinSwarm();
  TwinSwarm(const TwinSwarm&) = delete;
  TwinSwarm& operator=(const TwinSwarm&) = delete;

  void Start();
  /// Waits for the groups, which end with the stage kClose, or are told to give up.
  void Finish();
  [[nodiscard]] std::size_t groups() const { return groups_.size(); }
  /// Calls `each` for every twin. Its group must be quiet (told by `quiet_groups`) or finished.
  void ForEach(const std::function<void(const TwinScript&)>& each) const;
  /// From ping to pong; after Finish.
  [[nodiscard]] Histogram Pong() const;

 private:
  BrokerLibrary library_;
  TwinsShared& shared_;
  std::vector<std::unique_ptr<TwinGroup>> groups_;
  std::vector<std::jthread> threads_;
};

}  // namespace uplink::synthetic
