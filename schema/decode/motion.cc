#include "schema/decode/decode.h"
#include "schema/decode/fields.h"
#include "schema/limits.h"
#include "schema/rules/numbers.h"

namespace uplink::schema {
namespace {

std::optional<model::VelTwist> DecodeVelocity(wire::MotionTelemetry::Reader in,
                                              Violations& violations) {
  const Path root;
  const Path path = root.Field("velocity");
  if (!in.hasVelocity()) {
    violations.Content(MissingField(path, "is announced and a null pointer"));
    return std::nullopt;
  }
  const auto twist = in.getVelocity();
  model::VelTwist velocity{
      .linear_mps = InRange(violations, path.Field("linearMps"), twist.getLinearMps(),
                            {-kLinearMpsMax, kLinearMpsMax}),
      .angular_rps = InRange(violations, path.Field("angularRps"), twist.getAngularRps(),
                             {-kAngularRpsMax, kAngularRpsMax})};
  if (!velocity.linear_mps && !velocity.angular_rps) return std::nullopt;
  return velocity;
}

std::optional<model::Pose> DecodePose(wire::MotionTelemetry::Reader in, Violations& violations) {
  const Path root;
  const Path path = root.Field("pose");
  if (!in.hasPose()) {
    violations.Content(MissingField(path, "is announced and a null pointer"));
    return std::nullopt;
  }
  return JudgePose(violations, path, Raw(in.getPose()));
}

}  // namespace

model::MotionTelemetry DecodeMotionTelemetry(wire::MotionTelemetry::Reader in,
                                             Violations& violations) {
  model::MotionTelemetry out;
  out.unix_time_ms = Time(violations, in.getUnixTimeMs());
  if (in.getHasPose()) out.pose = DecodePose(in, violations);
  if (in.getHasVelocity()) out.velocity = DecodeVelocity(in, violations);
  if (in.getHasGpsFixType()) {
    out.gps_fix_type = Enum<model::GpsFixType>(violations, in.getGpsFixType());
  }
  out.gps_source = Enum<model::GpsSource>(violations, in.getGpsSource());
  // The source of a fix says nothing by itself.
  if (!out.pose && !out.velocity && !out.gps_fix_type) violations.RejectIfAnyDropped();
  return out;
}

}  // namespace uplink::schema
