#include "tools/uplink-fleet/drone/swarm.h"

#include <algorithm>

#include <pthread.h>

#include "tools/pki/directory.h"
#include "tools/pki/profile.h"

namespace uplink::synthetic {
namespace {

constexpr int kCertificateDays = 30;

}  // namespace

absl::StatusOr<std::unique_ptr<DroneSwarm>> DroneSwarm::Create(const SwarmOptions& options,
                                                               const Clock& clock,
                                                               DronesShared& shared) {
  const auto authority = pki::Directory(options.pki_directory).LoadAuthority();
  if (!authority.ok()) return authority.status();
  std::unique_ptr<DroneSwarm> swarm(new DroneSwarm(shared));
  for (std::size_t i = 0; i < std::min(options.threads, options.scenario.robots); ++i) {
    swarm->groups_.push_back(std::make_unique<DroneGroup>(options.scenario, clock, shared));
  }
  const ScenarioOptions& run = options.scenario.phases.front().options;
  for (std::size_t i = 0; i < options.scenario.robots; ++i) {
    const auto profile = pki::RobotProfile(DroneRuri(i), options.fleet, UavIdOf(i));
    if (!profile.ok()) return profile.status();
    auto credentials = (*authority)->Issue(*profile, kCertificateDays);
    if (!credentials.ok()) return credentials.status();
    swarm->groups_[i % swarm->groups_.size()]->Add(
        {.seed = run.seed, .index = i, .run = run.run},
        {.target = options.target,
         .server_ca = (*authority)->credentials().certificate_pem,
         .certificate = std::move(credentials->certificate_pem),
         .key = std::move(credentials->key_pem)});
  }
  return swarm;
}

DroneSwarm::~DroneSwarm() {
  shared_.abandon.store(true);
  Finish();
}

void DroneSwarm::Start() {
  for (const auto& group : groups_) {
    threads_.emplace_back([&group = *group] {
      pthread_setname_np(pthread_self(), "drones");
      group.Run();
    });
  }
}

void DroneSwarm::ForEach(const std::function<void(const DroneScript&)>& each) const {
  for (const auto& group : groups_) group->ForEach(each);
}

Latencies DroneSwarm::TakeLatencies() const {
  Latencies all;
  for (const auto& group : groups_) all.Merge(group->latencies());
  return all;
}

}  // namespace uplink::synthetic
