#include "schema/json/fields.h"
#include "schema/json/render.h"

namespace uplink::json {
namespace {

using boost::json::object;

object RenderVelocity(const model::VelTwist& velocity) {
  return Fields()
      .SetIf("linearMps", velocity.linear_mps)
      .SetIf("angularRps", velocity.angular_rps)
      .Take();
}

}  // namespace

object Render(const model::Pose& pose) {
  return Fields()
      .Set("latDeg", pose.lat_deg)
      .Set("lonDeg", pose.lon_deg)
      .SetIf("altitudeM", pose.altitude_m)
      .SetIf("headingDeg", pose.heading_deg)
      .Take();
}

object Render(const model::MotionTelemetry& body) {
  Fields fields;
  fields.Set("unixTimeMs", body.unix_time_ms);
  if (body.pose) fields.Set("pose", Render(*body.pose));
  if (body.velocity) fields.Set("velocity", RenderVelocity(*body.velocity));
  return fields.SetIf("gpsFixType", body.gps_fix_type).Set("gpsSource", body.gps_source).Take();
}

}  // namespace uplink::json
