#include "schema/json/fields.h"
#include "schema/json/render.h"

namespace uplink::json {
namespace {

boost::json::object RenderJoint(const model::RcanJoint& joint) {
  return Fields()
      .Set("joint", joint.joint)
      .SetIf("position_rad", joint.position_rad)
      .SetIf("velocity_rad_s", joint.velocity_rad_s)
      .SetIf("position_m", joint.position_m)
      .SetIf("velocity_m_s", joint.velocity_m_s)
      .SetIf("effort_nm", joint.effort_nm)
      .SetIf("temperature_c", joint.temperature_c)
      .SetIf("error_flags", joint.error_flags)
      .Set("timestamp_us", joint.timestamp_us)
      .Take();
}

boost::json::object RenderPosition(const model::RcanPosition& position) {
  return Fields()
      .Set("x", position.x_m)
      .Set("y", position.y_m)
      .SetIf("heading_rad", position.heading_rad)
      .Take();
}

}  // namespace

boost::json::object Render(const model::RcanState& state, std::string_view ruri) {
  Fields fields;
  fields.Set("ruri", std::string(ruri))
      .SetIf("seq", state.seq)
      .SetIf("uptime_ms", state.uptime_ms)
      .SetIf("battery_v", state.battery_v)
      .SetIf("battery_pct", state.battery_pct);
  if (state.position) fields.Set("position", RenderPosition(*state.position));
  return fields.Set("joints", ListOf(state.joints, RenderJoint))
      .SetIf("clock_source", state.clock_source)
      .Set("timestamp_us", state.timestamp_us)
      .Take();
}

}  // namespace uplink::json
