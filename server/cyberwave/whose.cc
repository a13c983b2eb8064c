#include "server/cyberwave/whose.h"

namespace uplink::cyberwave {

RobotKind RobotOf(const Judgement& judgement) {
  return model::cyberwave::IsSimulated(judgement.head.source.type) ? RobotKind::kSimulated
                                                                   : RobotKind::kReal;
}

std::string RuriOf(const Judgement& judgement) {
  return TwinRuri(judgement.topic.prefix, judgement.topic.id, RobotOf(judgement));
}

std::optional<RobotKind> SignOfLifeOf(const Judgement& judgement) {
  if (!judgement.sign_of_life) return std::nullopt;
  return RobotOf(judgement);
}

}  // namespace uplink::cyberwave
