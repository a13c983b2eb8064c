#include "tests/bench/world.h"

#include <string>

#include <sched.h>

#include "schema/base/check.h"
#include "tests/support/certificates.h"

namespace uplink::bench {

bool PinTo(int core) {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(static_cast<std::size_t>(core), &set);
  return sched_setaffinity(0, sizeof set, &set) == 0;
}

void World::MakeRobots(std::size_t robots) {
  identities.reserve(robots);
  for (std::size_t i = identities.size(); i < robots; ++i) {
    const testing::KeyPair pair = folder.authority().Issue(
        testing::RobotSpec("rcan://bench.local/robots/" + std::to_string(i)));
    auto identity = link::Identity::Parse(pair.certificate, pair.key);
    UPLINK_CHECK(identity.ok(), identity.status().ToString());
    identities.push_back(*std::move(identity));
  }
}

}  // namespace uplink::bench
