#include "storage/present.h"

#include <array>
#include <variant>

#include "schema/model/record.h"
#include "storage/bounds.h"
#include "storage/commit_record.h"
#include "storage/expiry.h"
#include "storage/refusal.h"

namespace uplink::storage {
namespace {

/// In the order of PresentKind.
constexpr std::array<PresentBound, kPresentKinds> kBounds = {{
    {kActiveFaultsPerRobotMax, false, TooManyActiveFaults},
    {kShapesPerRobotMax, true, TooManyShapes},
    {kObjectsPerRobotMax, true, TooManyObjects},
}};

/// One overload per kind that is present by a key.
struct ChangeOf {
  const CommitRecord& record;
  const StoreRules& rules;

  std::optional<PresentChange> operator()(const model::Fault& fault) const {
    const PresentKey key = {PresentKind::kFault, record.robot->ruri, fault.fault_id, fault.source};
    return PresentChange{key, fault.active, 0};
  }
  std::optional<PresentChange> operator()(const model::ShapeOp& op) const {
    const model::ReportedShape* shape = op.upsert();
    const std::int64_t expires_ms = shape == nullptr ? 0 : shape->expire_time_ms;
    return PresentChange{
        {PresentKind::kShape, record.robot->ruri, op.id(), {}}, shape != nullptr, expires_ms};
  }
  std::optional<PresentChange> operator()(const model::ObjectOp& op) const {
    const model::Object* object = op.upsert();
    const std::int64_t expires_ms =
        object == nullptr ? 0 : ExpiryOf(*object, record.received_at, rules);
    return PresentChange{
        {PresentKind::kObject, record.robot->ruri, op.id(), {}}, object != nullptr, expires_ms};
  }
  template <typename Other>
  std::optional<PresentChange> operator()(const Other& /*body*/) const {
    return std::nullopt;
  }
};

}  // namespace

std::optional<PresentChange> PresentChangeOf(const CommitRecord& record, const StoreRules& rules) {
  const auto* good = std::get_if<model::Record>(&record.content);
  if (good == nullptr) return std::nullopt;
  return std::visit(ChangeOf{record, rules}, good->body());
}

const PresentBound& BoundOf(PresentKind kind) { return kBounds[static_cast<std::size_t>(kind)]; }

}  // namespace uplink::storage
