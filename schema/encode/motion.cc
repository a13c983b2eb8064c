#include "schema/encode/encode_body.h"

namespace uplink::schema {

void EncodePose(const model::Pose& in, wire::Pose::Builder out) {
  out.setLatDeg(in.lat_deg);
  out.setLonDeg(in.lon_deg);
  out.setAltitudeM(in.altitude_m.value_or(kNan));
  out.setHeadingDeg(in.heading_deg.value_or(kNan));
}

void EncodeMember(const model::MotionTelemetry& in, wire::UplinkMsg::Builder message) {
  auto out = message.initMotionTelemetry();
  out.setUnixTimeMs(in.unix_time_ms);
  out.setHasPose(in.pose.has_value());
  if (in.pose) EncodePose(*in.pose, out.initPose());
  out.setHasVelocity(in.velocity.has_value());
  if (in.velocity) {
    auto velocity = out.initVelocity();
    velocity.setLinearMps(in.velocity->linear_mps.value_or(kNanF));
    velocity.setAngularRps(in.velocity->angular_rps.value_or(kNanF));
  }
  out.setHasGpsFixType(in.gps_fix_type.has_value());
  if (in.gps_fix_type) out.setGpsFixType(Enum<wire::GpsFixType>(*in.gps_fix_type));
  out.setGpsSource(Enum<wire::GpsSource>(in.gps_source));
}

}  // namespace uplink::schema
