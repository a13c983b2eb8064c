#include "server/cyberwave/whose.h"

#include "storage/origin.h"

namespace uplink::cyberwave {

std::optional<RobotKind> RobotOf(const Judgement& judgement) {
  if (!judgement.topic.identified || !IsOfTwin(judgement.topic.kind)) return std::nullopt;
  return model::cyberwave::IsSimulated(judgement.head.source.type) ? RobotKind::kSimulated
                                                                   : RobotKind::kReal;
}

std::string RuriOf(const Judgement& judgement) {
  const std::optional<RobotKind> kind = RobotOf(judgement);
  if (!kind) return storage::NoRobotOf(judgement.topic.prefix);
  return TwinRuri(judgement.topic.prefix, judgement.topic.id, *kind);
}

std::optional<RobotKind> SignOfLifeOf(const Judgement& judgement) {
  return judgement.sign_of_life ? RobotOf(judgement) : std::nullopt;
}

}  // namespace uplink::cyberwave
