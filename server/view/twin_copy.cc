#include "server/view/twin_copy.h"

#include <memory>

#include "schema/cyberwave/ruri.h"

namespace uplink::view {

std::size_t CopyTwin(const cyberwave::Twins* twins, RobotView& robot) {
  if (twins == nullptr || robot.state.foreign) return 0;
  if (!cyberwave::IsTwinRuri(robot.id.ruri)) return 0;
  const cyberwave::TwinPtr twin = twins->Find(robot.id.ruri);
  if (twin == nullptr) return 0;
  twin->LookAt([&robot](const cyberwave::TwinParts& parts) {
    robot.twin = std::make_shared<const cyberwave::TwinParts>(parts);
  });
  return twin->bytes();
}

}  // namespace uplink::view
