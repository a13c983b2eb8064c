#include "tests/support/relay_world.h"

namespace uplink::testing {

ChannelSpec RelayWorld::SpecFor(const std::string& ruri) const {
  return {.port = port(),
          .server_ca = authority.certificate(),
          .identity = authority.Issue(RobotSpec(ruri))};
}

std::shared_ptr<grpc::Channel> RelayWorld::Channel(const std::string& ruri) const {
  return MakeChannel(SpecFor(ruri));
}

std::shared_ptr<grpc::Channel> RelayWorld::Channel(const KeyPair& identity) const {
  return MakeChannel({.port = port(), .server_ca = authority.certificate(), .identity = identity});
}

}  // namespace uplink::testing
