#include "server/view/glance.h"

#include <utility>

#include "schema/cyberwave/ruri.h"

namespace uplink::view {
namespace {

/// True unless another process holds the robot.
bool TakeState(const robot::Robot& robot, Glance& glance) {
  bool is_ours = true;
  robot.state.LookAt([&](const robot::StateView& view) {
    is_ours = !view.foreign;
    glance.vitals = VitalsOf({.parts = &view.parts,
                              .status_arrived = view.status_arrived,
                              .rcan_arrived = view.rcan_arrived});
    glance.faulted = view.parts.status && view.parts.status->faulted;
    glance.last_heard = view.last_sign_of_life;
    if (view.backlog) glance.backlog = view.backlog->uplinks;
    glance.agent_version = view.reported.agent_version;
    glance.software_version = view.reported.software_version;
  });
  return is_ours;
}

void TakeTwin(const cyberwave::Twins* twins, const std::string& ruri, Vitals& vitals) {
  if (twins == nullptr || !cyberwave::IsTwinRuri(ruri)) return;
  const cyberwave::TwinPtr twin = twins->Find(ruri);
  if (twin == nullptr) return;
  twin->LookAt([&vitals](const cyberwave::TwinParts& parts) {
    vitals = VitalsOf({.twin = &parts}, std::move(vitals));
  });
}

void TakeDrone(const uncrew::Drones* drones, const robot::Robot& robot, Vitals& vitals) {
  if (drones == nullptr || !robot.calls.spoke()) return;
  const uncrew::DronePtr drone = drones->Find(robot.ruri());
  if (drone == nullptr) return;
  drone->LookAt([&vitals](const uncrew::LiveSamples& live) {
    vitals = VitalsOf({.drone = &live}, std::move(vitals));
  });
}

}  // namespace

Glance GlanceOf(const robot::Robot& robot, const LiveSources& sources) {
  Glance glance;
  if (TakeState(robot, glance)) {
    TakeTwin(sources.twins, robot.ruri(), glance.vitals);
    TakeDrone(sources.drones, robot, glance.vitals);
  }
  robot::AgentFacts::View agent = robot.agent.Get();
  if (!agent.version.empty()) glance.agent_version = std::move(agent.version);
  glance.certificate_not_after = agent.certificate_not_after;
  return glance;
}

}  // namespace uplink::view
