#include "server/view/robot_mark.h"

#include <optional>
#include <string>

#include <absl/hash/hash.h>

#include "schema/cyberwave/ruri.h"

namespace uplink::view {
namespace {

/// Of times that are there, and not.
std::int64_t Ms(const std::optional<SystemTime>& time) { return time ? UnixMs(*time) : -1; }

std::size_t OfState(const robot::StateSnapshot& state) {
  std::size_t mark = absl::HashOf(state.live_changes, static_cast<int>(state.presence),
                                  UnixMs(state.presence_since), Ms(state.last_sign_of_life),
                                  Ms(state.parked_until), state.flapping, state.clock_skew_ms,
                                  state.fields_dropped, state.last_end.has_value());
  if (state.backlog) {
    mark = absl::HashOf(mark, state.backlog->uplinks, Ms(state.backlog->oldest_unsent),
                        UnixMs(state.backlog->said_at));
  }
  if (state.foreign) {
    mark = absl::HashOf(mark, state.foreign->held_by, Ms(state.foreign->written_at));
  }
  return mark;
}

std::size_t OfSession(const robot::SessionView& session) {
  return absl::HashOf(session.connected, UnixMs(session.connected_since),
                      session.session.has_value(), session.settled_seq, session.missing,
                      session.gateway, session.contested, static_cast<int>(session.held_back),
                      UnixMs(session.held_back_since));
}

std::uint64_t OfTwin(const cyberwave::Twins* twins, const std::string& ruri) {
  if (twins == nullptr || !cyberwave::IsTwinRuri(ruri)) return 0;
  const cyberwave::TwinPtr twin = twins->Find(ruri);
  return twin == nullptr ? 0 : twin->changes() + 1;
}

std::uint64_t OfDrone(const uncrew::Drones* drones, const robot::Robot& robot) {
  if (drones == nullptr || !robot.calls.spoke()) return 0;
  const uncrew::DronePtr drone = drones->Find(robot.ruri());
  if (drone == nullptr) return 0;
  std::uint64_t changes = 0;
  drone->LookAt([&changes](const uncrew::LiveSamples& live) { changes = live.changes() + 1; });
  return changes;
}

}  // namespace

std::uint64_t MarkOf(const robot::Robot& robot, const LiveSources& sources) {
  std::uint64_t limited = 0;
  for (std::size_t kind = 0; kind < metrics::kKinds; ++kind) limited += robot.rates.limited(kind);
  const robot::AgentFacts::View agent = robot.agent.Get();
  return absl::HashOf(robot.id()->fleet,
                      OfState(robot.state.Snapshot(robot::RobotState::Parts::kNone)),
                      OfSession(robot.sessions.View()), limited, agent.version,
                      Ms(agent.certificate_not_after), robot.calls.open(), robot.calls.spoke(),
                      OfTwin(sources.twins, robot.ruri()), OfDrone(sources.drones, robot));
}

}  // namespace uplink::view
