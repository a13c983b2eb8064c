#include "server/view/live_parts.h"

#include "schema/json/fields.h"
#include "schema/json/render.h"
#include "server/view/struct.h"

namespace uplink::view {
namespace {

using google::protobuf::Struct;
using json::Fields;
using json::Render;

/// Key to rendered value; unset if there is none.
template <typename Items, typename RenderItem>
void SetByKey(const Items& items, Struct* (v1::Robot::*mutable_part)(), v1::Robot& robot,
              RenderItem render) {
  if (items.empty()) return;
  Fields fields;
  for (const auto& [key, value] : items) fields.Set(key, render(value));
  *(robot.*mutable_part)() = ToStruct(fields.Take());
}

boost::json::object RenderExtra(const robot::Extra& extra) {
  return Fields().Set("value", Render(extra.value)).Set("sampledAtMs", extra.sampled_at_ms).Take();
}

/// What the robot said, and the server's own count of what it left out.
boost::json::object RenderRcan(const model::RcanState& state, const std::string& ruri) {
  boost::json::object fields = Render(state, ruri);
  fields["seq_missing"] = state.seq_missing;
  return fields;
}

}  // namespace

void SetLiveParts(const robot::LiveParts& live, const PartSet& wanted, v1::Robot& robot) {
  const auto render = [](const auto& value) { return Render(value); };
  if (wanted.Has(Part::kMotion) && live.motion)
    *robot.mutable_motion() = ToStruct(Render(*live.motion));
  if (wanted.Has(Part::kStatus) && live.status)
    *robot.mutable_status() = ToStruct(Render(*live.status));
  if (wanted.Has(Part::kUsage) && live.usage)
    *robot.mutable_usage() = ToStruct(Render(*live.usage));
  if (wanted.Has(Part::kRcanState) && live.rcan) {
    *robot.mutable_rcan_state() = ToStruct(RenderRcan(*live.rcan, robot.ruri()));
  }
  if (wanted.Has(Part::kExtras)) {
    SetByKey(live.extras.items(), &v1::Robot::mutable_extras, robot, RenderExtra);
  }
  if (wanted.Has(Part::kHealth)) {
    SetByKey(live.health.items(), &v1::Robot::mutable_health, robot, render);
  }
  if (wanted.Has(Part::kConsumables)) {
    SetByKey(live.consumables.items(), &v1::Robot::mutable_consumables, robot, render);
  }
  if (wanted.Has(Part::kDirectives)) {
    SetByKey(live.directives.items(), &v1::Robot::mutable_directives, robot, render);
  }
}

}  // namespace uplink::view
