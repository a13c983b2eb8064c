#include "tests/component/front/front_client.h"

namespace uplink::testing {

KeyPair RobotKeys(const ListenerWorld& world, int number) {
  return world.authority.Issue(RobotSpec(RuriOf(number)));
}

KeyPair GatewayKeys(const ListenerWorld& world) {
  CertificateSpec spec;
  spec.units = {"gateway"};
  return world.authority.Issue(spec);
}

RawHttp2::Options ClientOf(const ListenerWorld& world, const KeyPair& identity,
                           const std::string& source) {
  RawHttp2::Options options;
  options.port = world.port();
  options.server_ca = world.authority.certificate();
  options.identity = identity;
  options.source = source;
  return options;
}

std::int64_t TurnedAwayFor(const ListenerWorld& world, transport::TurnedAway cause) {
  return world.relay_probe.turned_away_total[static_cast<std::size_t>(cause)].value();
}

}  // namespace uplink::testing
