#include "tools/uplink-fleet/broker/twin_swarm.h"

#include <algorithm>

namespace uplink::synthetic {

TwinSwarm::TwinSwarm(const TwinSwarmOptions& options, const Clock& clock, TwinsShared& shared)
    : shared_(shared) {
  const std::size_t wanted = (options.twins + kTwinsPerConnection - 1) / kTwinsPerConnection;
  const std::size_t connections = std::clamp(wanted, std::size_t{1}, kBrokerConnectionsMax);
  std::size_t first = 0;
  for (std::size_t i = 0; i < connections; ++i) {
    const std::size_t end = options.twins * (i + 1) / connections;
    TwinGroupOptions group{.broker = options.broker,
                           .seed = options.seed,
                           .run = options.run,
                           .prefix = options.prefix,
                           .rate_hz = options.rate_hz,
                           .first = first,
                           .twins = end - first};
    group.broker.version = i % 2 == 0 ? MqttVersion::k5 : MqttVersion::k311;
    group.broker.client_id = "uplink-fleet-" + options.run + "-" + std::to_string(i);
    groups_.push_back(std::make_unique<TwinGroup>(group, clock, shared));
    first = end;
  }
}

TwinSwarm::~TwinSwarm() {
  shared_.abandon.store(true);
  Finish();
}

void TwinSwarm::Start() {
  for (const auto& group : groups_) {
    threads_.emplace_back([&group = *group] { group.Run(); });
  }
}

void TwinSwarm::Finish() { threads_.clear(); }

void TwinSwarm::ForEach(const std::function<void(const TwinScript&)>& each) const {
  for (const auto& group : groups_) {
    for (const auto& twin : group->twins()) each(*twin);
  }
}

Histogram TwinSwarm::Pong() const {
  Histogram pong;
  for (const auto& group : groups_) pong.Merge(group->pong());
  return pong;
}

}  // namespace uplink::synthetic
