#pragma once

#include <optional>
#include <string>

#include "schema/cyberwave/judge.h"
#include "schema/cyberwave/ruri.h"

namespace uplink::cyberwave {

/// Which of its twin's robots a message is of. Pure.
[[nodiscard]] RobotKind RobotOf(const Judgement& judgement);

/// The RURI of that robot; the topic must be one of a twin. Pure.
[[nodiscard]] std::string RuriOf(const Judgement& judgement);

/// The robot that is there because of this message; nothing if it proves nothing: marks come from
/// any client, a viewer's too, and commands from whoever gives them. What the rules, or the
/// messages before it, made of it changes nothing. Retained messages are not asked about: they may
/// be of any age. Pure.
[[nodiscard]] std::optional<RobotKind> SignOfLifeOf(const Judgement& judgement);

}  // namespace uplink::cyberwave
