#include "tests/bench/world.h"

#include <csignal>
#include <string>

#include <sched.h>
#include <sys/resource.h>

#include "schema/base/check.h"
#include "tests/bench/load/robots.h"
#include "tests/support/certificates.h"

namespace uplink::bench {

bool PinTo(int core) {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(static_cast<std::size_t>(core), &set);
  return sched_setaffinity(0, sizeof set, &set) == 0;
}

void PrepareLoad() {
  std::signal(SIGPIPE, SIG_IGN);
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

link::LinkOptions World::LinkTo(std::uint16_t port, link::Alpn alpn) const {
  link::LinkOptions options;
  options.tls = *link::TlsClient::Create(folder.authority().certificate(), alpn);
  options.address = *link::Resolve("127.0.0.1:" + std::to_string(port));
  return options;
}

link::Identity World::Issue(const testing::CertificateSpec& spec) const {
  const testing::KeyPair pair = folder.authority().Issue(spec);
  auto identity = link::Identity::Parse(pair.certificate, pair.key);
  UPLINK_CHECK(identity.ok(), identity.status().ToString());
  return *std::move(identity);
}

void World::MakeRobots(std::size_t robots) {
  identities.reserve(robots);
  for (std::size_t i = identities.size(); i < robots; ++i) {
    identities.push_back(Issue(testing::RobotSpec(BenchRuri(i))));
  }
}

std::vector<link::Identity> World::MakeGateways(std::size_t gateways, std::size_t robots) const {
  std::vector<link::Identity> made;
  for (std::size_t gateway = 0; gateway < gateways; ++gateway) {
    testing::CertificateSpec spec;
    spec.common_names = {"gateway " + std::to_string(gateway)};
    spec.units = {"gateway"};
    for (std::size_t i = gateway; i < robots; i += gateways) spec.uris.push_back(BenchRuri(i));
    made.push_back(Issue(spec));
  }
  return made;
}

}  // namespace uplink::bench
