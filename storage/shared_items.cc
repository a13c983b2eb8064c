#include "storage/shared_items.h"

namespace uplink::storage {

namespace {

// One for each kind of row: the compiler finds the one that is missing.
ItemKey KeyOf(const ShapeRow& shape) {
  return {PresentKind::kShape, shape.robot.ruri, shape.identity.id};
}
ItemKey KeyOf(const ObjectRow& object) {
  return {PresentKind::kObject, object.robot.ruri, object.id};
}

}  // namespace

ItemKey SharedItem::Key() const {
  return std::visit([](const auto& one) { return KeyOf(one); }, row);
}

const model::RobotId& SharedItem::robot() const {
  return std::visit([](const auto& one) -> const model::RobotId& { return one.robot; }, row);
}

std::int64_t SharedItem::expires_at_ms() const {
  return std::visit([](const auto& one) { return one.expires_at_ms; }, row);
}

}  // namespace uplink::storage
