#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tests/support/listener_world.h"
#include "tests/support/relay_samples.h"
#include "tests/support/test_agent.h"

namespace uplink::testing {

/// A whole relay on loopback, and agents for it by the gRPC library.
class RelayWorld final : public ListenerWorld {
 public:
  RelayWorld() : RelayWorld(Options{}) {}
  explicit RelayWorld(const Options& given) : ListenerWorld(given) {}

  [[nodiscard]] std::shared_ptr<grpc::Channel> Channel(const std::string& ruri) const {
    return MakeChannel(SpecFor(ruri));
  }
  [[nodiscard]] std::shared_ptr<grpc::Channel> Channel(const KeyPair& identity) const {
    return MakeChannel(
        {.port = port(), .server_ca = authority.certificate(), .identity = identity});
  }
  [[nodiscard]] ChannelSpec SpecFor(const std::string& ruri) const {
    return {.port = port(),
            .server_ca = authority.certificate(),
            .identity = authority.Issue(RobotSpec(ruri))};
  }
};

}  // namespace uplink::testing
