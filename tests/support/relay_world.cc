#include "tests/support/relay_world.h"

#include "server/front/server.h"
#include "server/relay/server.h"

namespace uplink::testing {
namespace {

ListenerWorld::StartListener StartOf(config::Transport transport) {
  switch (transport) {
    case config::Transport::kNative:
      return front::FrontServer::Start;
    case config::Transport::kGrpc:
      return relay::RelayServer::Start;
  }
  return nullptr;
}

}  // namespace

RelayWorld::RelayWorld(const Options& given) : ListenerWorld(given, StartOf(given.transport)) {}

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
