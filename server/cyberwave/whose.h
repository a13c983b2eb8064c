#pragma once

#include <optional>
#include <string>

#include "schema/cyberwave/judge.h"
#include "schema/cyberwave/ruri.h"

namespace uplink::cyberwave {

/// The robot of its twin that a message belongs to. Empty for a message of an environment, a
/// workflow run, a ping or another topic, or of a topic whose id is not a UUID. Pure.
[[nodiscard]] std::optional<RobotKind> RobotOf(const Judgement& judgement);

/// The RURI under which the message's records and its row of quarantine are stored: that robot's,
/// or that of its prefix's stand-in (storage::NoRobotOf). Pure.
[[nodiscard]] std::string RuriOf(const Judgement& judgement);

/// The robot that this message proves to be alive. Empty if it proves nothing: any client sends
/// marks, a viewer too, and any client gives commands. A rejected or late message counts too. Do
/// not ask about retained messages, which may be of any age. Pure.
[[nodiscard]] std::optional<RobotKind> SignOfLifeOf(const Judgement& judgement);

}  // namespace uplink::cyberwave
