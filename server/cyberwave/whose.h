#pragma once

#include <optional>
#include <string>

#include "schema/cyberwave/judge.h"
#include "schema/cyberwave/ruri.h"

namespace uplink::cyberwave {

/// Which of its twin's robots a message is of; nothing if it is of none: of an environment, a
/// workflow run, a ping or another topic, or of a topic whose id is no UUID. Pure.
[[nodiscard]] std::optional<RobotKind> RobotOf(const Judgement& judgement);

/// In whose name the message's records and its row of quarantine stand: the RURI of that robot; of
/// what is of none what stands in a robot's place under its prefix (storage::NoRobotOf). Pure.
[[nodiscard]] std::string RuriOf(const Judgement& judgement);

/// The robot that is there because of this message; nothing if it proves nothing: marks come from
/// any client, a viewer's too, and commands from whoever gives them. What the rules, or the
/// messages before it, made of it changes nothing. Retained messages are not asked about: they may
/// be of any age. Pure.
[[nodiscard]] std::optional<RobotKind> SignOfLifeOf(const Judgement& judgement);

}  // namespace uplink::cyberwave
