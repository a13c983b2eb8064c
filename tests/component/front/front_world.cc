#include "tests/component/front/front_world.h"

#include <algorithm>
#include <fstream>
#include <utility>

#include <sys/resource.h>

#include "schema/base/check.h"
#include "server/config/tls_groups.h"

namespace uplink::testing {
namespace {

rlimit Descriptors() {
  rlimit limit{};
  UPLINK_CHECK(getrlimit(RLIMIT_NOFILE, &limit) == 0, "the system knows its limits");
  return limit;
}

void SetDescriptors(std::uint64_t count) {
  rlimit limit = Descriptors();
  limit.rlim_cur = std::min<rlim_t>(count, limit.rlim_max);
  UPLINK_CHECK(setrlimit(RLIMIT_NOFILE, &limit) == 0, "a limit within the hard one");
}

}  // namespace

RelayWorld::Options With12() {
  config::TlsConfig tls;
  tls.min_version = config::TlsVersion::k12;
  return {.session = {},
          .journal = {},
          .tls = {.minimum = tls.min_version, .groups = config::ServedGroups(tls)}};
}

bool ServesNewRobot(const RelayWorld& world, int number, std::chrono::milliseconds patience) {
  TestAgent agent(world.Channel(RuriOf(number)), {.patience = patience});
  if (!agent.Connect(SessionOf(1))) return false;
  agent.Send(BatchFrame({{1, FaultPayload("new")}}));
  if (!agent.ReadThrough(1)) return false;
  agent.HalfClose();
  return agent.End().ok();
}

std::size_t ResidentBytes() {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word) {
    std::size_t kibibytes = 0;
    if (word == "VmRSS:" && status >> kibibytes) return kibibytes * 1024;
  }
  return 0;
}

DescriptorLimit::DescriptorLimit(std::size_t descriptors_max) : before_(Descriptors().rlim_cur) {
  SetDescriptors(descriptors_max);
}

DescriptorLimit::~DescriptorLimit() { SetDescriptors(before_); }

}  // namespace uplink::testing
