#include "server/uncrew/samples.h"

#include <algorithm>

namespace uplink::uncrew {

using enum metrics::MetricId;

void AddSamples(const Drones& drones, const AvatarProbe& probe, SteadyTime now,
                metrics::Exposition& page) {
  for (const model::uncrew::TypeRow& row : model::uncrew::kTypeRows) {
    const auto& by_outcome = probe.publishes_total[static_cast<std::size_t>(row.type)];
    for (std::size_t i = 0; i < by_outcome.size(); ++i) {
      page.Add(kAvatarPublishes, by_outcome[i], {row.label(), kOutcomeWords[i]});
    }
  }
  page.Add(kAvatarAnswerSeconds, probe.answer_seconds.live, {"live"});
  page.Add(kAvatarAnswerSeconds, probe.answer_seconds.durable, {"durable"});
  page.Add(kAvatarDrones, drones.size());
  std::size_t open = 0;
  SteadyTime oldest = now;
  for (const DronePtr& drone : drones.All()) {
    // It sends its samples to another server now.
    if (drone->robot()->state.foreign()) continue;
    drone->LookAt([&](const LiveSamples& live) {
      open += live.requests().size();
      for (const auto& [id, since] : live.requests()) oldest = std::min(oldest, since);
    });
  }
  page.Add(kOperatorRequestsOpen, open);
  page.Add(kOperatorRequestOldest, std::chrono::duration<double>(now - oldest).count());
}

}  // namespace uplink::uncrew
