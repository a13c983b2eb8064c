#include "schema/decode/spatial.h"

/// Shapes and objects: durable, so every violation rejects.
namespace uplink::schema {
namespace {

model::ReportedShape DecodeReported(wire::ReportedShape::Reader in, const Path& path,
                                    Violations& violations) {
  auto out = DecodeArea<model::ReportedShape>(in, path, violations);
  out.expire_time_ms = Time(violations, in.getExpireTimeMs());
  return out;
}

std::optional<model::Trajectory> DecodeTrajectory(wire::Object::Reader in, const Path& path,
                                                  Violations& violations) {
  if (!in.hasTrajectory()) return std::nullopt;
  const auto trajectory = in.getTrajectory();
  const auto finite = [&](std::string_view name, double value) {
    return Finite(violations, path.Field(name), value).value_or(0);
  };
  return model::Trajectory{
      .speed_mps = finite("speedMps", trajectory.getSpeedMps()),
      .course_deg = finite("courseDeg", trajectory.getCourseDeg()),
      .vertical_rate_mps = finite("verticalRateMps", trajectory.getVerticalRateMps())};
}

model::Object DecodeTracked(wire::Object::Reader in, const Path& path, Violations& violations) {
  model::Object out;
  out.id = RequiredText(violations, path.Field("id"), View(in.getId()), kIdBytesMax);
  out.name = DurableText(violations, path.Field("name"), View(in.getName()), kNameBytesMax);
  out.unix_time_ms = Time(violations, in.getUnixTimeMs());
  out.expires_unix_time_ms = Time(violations, in.getExpiresUnixTimeMs());
  out.scope = Enum<model::ScopeType>(violations, in.getScope());
  out.object_type = Enum<model::ObjectType>(violations, in.getObjectType());
  const Path location = path.Field("location");
  if (in.hasLocation()) {
    out.location = JudgePose(violations, location, Raw(in.getLocation())).value_or(model::Pose());
  } else {
    violations.Content(MissingField(location, "is a null pointer"));
  }
  out.trajectory = DecodeTrajectory(in, path.Field("trajectory"), violations);
  out.radius_m = NotNegative(violations, path.Field("radiusM"), in.getRadiusM()).value_or(0);
  return out;
}

}  // namespace

model::AssetIdentity DecodeIdentity(wire::AssetIdentity::Reader in, const Path& path,
                                    Violations& violations) {
  return {.id = RequiredText(violations, path.Field("id"), View(in.getId()), kIdBytesMax),
          .name = DurableText(violations, path.Field("name"), View(in.getName()), kNameBytesMax),
          .rev = in.getRev(),
          .hash = DurableText(violations, path.Field("hash"), View(in.getHash()), kIdBytesMax)};
}

model::ShapeOp DecodeShape(wire::ReportedShapeOp::Reader in, Violations& violations) {
  return DecodeOp<model::ShapeOp>(in, violations, DecodeReported);
}

model::ObjectOp DecodeObject(wire::ObjectOp::Reader in, Violations& violations) {
  return DecodeOp<model::ObjectOp>(in, violations, DecodeTracked);
}

}  // namespace uplink::schema
