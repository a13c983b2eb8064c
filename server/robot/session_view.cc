#include "server/robot/session_view.h"

namespace uplink::robot {

SessionView ViewOf(const Takeover& takeover, const HeldBackTrack& held_back) {
  SessionView view;
  view.connected = static_cast<bool>(takeover.current());
  view.connected_since = takeover.connected_since();
  view.gateway = takeover.gateway();
  view.contested = takeover.contested();
  view.held_back = held_back.by();
  view.held_back_since = held_back.since();
  return view;
}

std::optional<storage::SettledSession> SettledOf(const SessionMemory* memory,
                                                 const std::optional<model::SessionId>& session) {
  if (memory == nullptr) return std::nullopt;
  return storage::SettledSession{*session, memory->numbers.through()};
}

}  // namespace uplink::robot
