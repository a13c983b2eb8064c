#include "server/view/glance.h"

#include <utility>

#include "schema/cyberwave/ruri.h"
#include "schema/json/text.h"

namespace uplink::view {
namespace {

void TakeState(const robot::Robot& robot, Glance& glance) {
  robot.state.LookAt([&](const robot::StateView& view) {
    glance.foreign = view.foreign;
    if (view.foreign) return;
    glance.vitals = VitalsOf({.parts = &view.parts,
                              .status_arrived = view.status_arrived,
                              .rcan_arrived = view.rcan_arrived});
    glance.faulted = view.parts.status && view.parts.status->faulted;
    glance.last_heard = view.last_sign_of_life;
    if (view.backlog) glance.backlog = view.backlog->uplinks;
    FillVersions(view.reported.agent_version, view.reported.software_version, glance);
  });
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

/// As the store told it.
Glance ForeignGlance(const GlanceMap* foreign, const std::string& ruri) {
  Glance glance;
  if (foreign != nullptr) {
    const auto known = foreign->find(ruri);
    if (known != foreign->end()) glance = known->second;
  }
  glance.foreign = true;
  return glance;
}

}  // namespace

Glance GlanceOf(const robot::Robot& robot, const LiveSources& sources) {
  robot::AgentFacts::View agent = robot.agent.Get();
  Glance glance{.agent_version = std::move(agent.version)};
  TakeState(robot, glance);
  if (!glance.foreign) {
    TakeTwin(sources.twins, robot.ruri(), glance.vitals);
    TakeDrone(sources.drones, robot, glance.vitals);
  } else {
    glance = ForeignGlance(sources.foreign, robot.ruri());
  }
  glance.certificate_not_after = agent.certificate_not_after;
  return glance;
}

void FillVersions(std::string_view agent, std::string_view software, Glance& glance) {
  if (glance.agent_version.empty()) glance.agent_version = agent;
  if (glance.software_version.empty()) glance.software_version = software;
}

void FillVersions(std::string_view agent_info, Glance& glance) {
  FillVersions(json::StringIn(agent_info, "agentVersion").value_or(""),
               json::StringIn(agent_info, "softwareVersion").value_or(""), glance);
}

}  // namespace uplink::view
