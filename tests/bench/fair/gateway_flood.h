#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tests/bench/fair/misbehaviour.h"
#include "tools/link/http2_link.h"

namespace uplink::bench {

/// Streams of the gateway, each for a robot of its own, and its connections.
inline constexpr std::size_t kGatewayStreams = 50;
inline constexpr std::size_t kGatewayLinks = 5;

/// The robots of the gateway: their names begin with `ruri`.
[[nodiscard]] std::vector<std::string> GatewayRobots(const std::string& ruri);

/// A gateway all of whose robots send events as fast as they are read.
class GatewayFlood final : public Misbehaviour {
 public:
  /// For GatewayRobots(ruri).
  GatewayFlood(BadWorld& world, const std::string& ruri);

  void Act() override;
  [[nodiscard]] bool at_work() const override { return at_work_; }

 private:
  struct Robot {
    BadSession session;
    std::unique_ptr<BadStream> stream;
    std::uint64_t events = 0;
  };
  struct Link {
    std::shared_ptr<link::Http2Link> link;
    std::vector<Robot> robots;
    SteadyTime tried;
  };

  void Mend(Link& link, SteadyTime now);
  void SendEvents(Robot& robot);

  BadWorld& world_;
  std::vector<Link> links_;
  bool at_work_ = false;
};

}  // namespace uplink::bench
