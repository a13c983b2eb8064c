#include "storage/shared_items.h"

namespace uplink::storage {

ItemKey SharedItem::Key() const {
  if (const auto* shape = std::get_if<ShapeRow>(&row)) {
    return {PresentKind::kShape, shape->robot.ruri, shape->identity.id};
  }
  const auto& object = std::get<ObjectRow>(row);
  return {PresentKind::kObject, object.robot.ruri, object.id};
}

const model::RobotId& SharedItem::robot() const {
  return std::visit([](const auto& one) -> const model::RobotId& { return one.robot; }, row);
}

std::int64_t SharedItem::expires_at_ms() const {
  return std::visit([](const auto& one) { return one.expires_at_ms; }, row);
}

}  // namespace uplink::storage
