#include "schema/rules/spatial.h"

#include <utility>

#include "schema/decode/decode.h"
#include "schema/decode/fields.h"
#include "schema/limits.h"
#include "schema/rules/numbers.h"
#include "schema/rules/texts.h"

/// Shapes and objects: durable, so every fault rejects. Positions are counted before any is read.
namespace uplink::schema {
namespace {

using WirePositions = capnp::List<wire::GeoPoint2>::Reader;
using WireLines = capnp::List<capnp::List<wire::GeoPoint2>>::Reader;

/// Counts lines, rings and positions of one shape; stops the walk at the first bound passed.
class ShapeSize {
 public:
  ShapeSize(Faults& faults, const Path& path) : faults_(faults), path_(path) {}

  [[nodiscard]] bool AddParts(std::size_t parts) {
    parts_ += parts;
    if (parts_ <= kShapePartsMax) return true;
    faults_.Reject(TooManyItems(path_, parts_, kShapePartsMax, "lines or rings"));
    return false;
  }
  [[nodiscard]] bool AddPositions(std::size_t positions) {
    positions_ += positions;
    if (positions_ <= kShapePositionsMax) return true;
    faults_.Reject(TooManyItems(path_, positions_, kShapePositionsMax, "positions"));
    return false;
  }
  [[nodiscard]] bool AddLines(const WireLines& lines) {
    if (!AddParts(lines.size())) return false;
    for (const auto line : lines) {
      if (!AddPositions(line.size())) return false;
    }
    return true;
  }
  [[nodiscard]] bool AddPolygon(wire::PolygonData::Reader polygon) {
    return AddParts(1) && AddPositions(polygon.getExterior().size()) &&
           AddLines(polygon.getHoles());
  }

 private:
  Faults& faults_;
  const Path& path_;
  std::size_t parts_ = 0;
  std::size_t positions_ = 0;
};

bool SizeIsGood(wire::ShapeData::Reader in, const Path& path, Faults& faults) {
  ShapeSize size(faults, path);
  switch (in.which()) {
    case wire::ShapeData::POINT:
      return true;
    case wire::ShapeData::MULTI_POINT:
      return size.AddPositions(in.getMultiPoint().size());
    case wire::ShapeData::LINE_STRING:
      return size.AddPositions(in.getLineString().size());
    case wire::ShapeData::MULTI_LINE_STRING:
      return size.AddLines(in.getMultiLineString());
    case wire::ShapeData::POLYGON:
      return size.AddPolygon(in.getPolygon());
    case wire::ShapeData::MULTI_POLYGON: {
      const auto polygons = in.getMultiPolygon();
      if (polygons.size() > kShapePartsMax) return size.AddParts(polygons.size());
      for (const auto polygon : polygons) {
        if (!size.AddPolygon(polygon)) return false;
      }
      return true;
    }
  }
  faults.Reject(UnknownVariant(path, static_cast<unsigned>(in.which())));
  return false;
}

bool LongEnough(Faults& faults, const Path& path, std::size_t count, std::size_t min,
                std::string_view what) {
  if (count >= min) return true;
  faults.Content(TooFewItems(path, count, min, what));
  return false;
}

model::Positions DecodePositions(const WirePositions& in, const Path& path, std::size_t min,
                                 Faults& faults) {
  model::Positions out;
  if (!LongEnough(faults, path, in.size(), min, "positions")) return out;
  out.reserve(in.size());
  for (unsigned i = 0; i < in.size() && !faults.rejected(); ++i) {
    out.push_back(
        JudgePosition(faults, path.Item(i), {.lon = in[i].getLon(), .lat = in[i].getLat()}));
  }
  return out;
}

std::vector<model::Positions> DecodeLines(const WireLines& in, const Path& path, std::size_t min,
                                          Faults& faults) {
  std::vector<model::Positions> out;
  out.reserve(in.size());
  for (unsigned i = 0; i < in.size() && !faults.rejected(); ++i) {
    out.push_back(DecodePositions(in[i], path.Item(i), min, faults));
  }
  return out;
}

model::PolygonData DecodePolygon(wire::PolygonData::Reader in, const Path& path, Faults& faults) {
  return {.exterior =
              DecodePositions(in.getExterior(), path.Field("exterior"), kRingPositionsMin, faults),
          .holes = DecodeLines(in.getHoles(), path.Field("holes"), kRingPositionsMin, faults)};
}

/// The member of a shape whose size was found good.
model::ShapeData DecodeMember(wire::ShapeData::Reader in, const Path& data, Faults& faults) {
  switch (in.which()) {
    case wire::ShapeData::POINT:
      return JudgePosition(faults, data.Field("point"),
                           {.lon = in.getPoint().getLon(), .lat = in.getPoint().getLat()});
    case wire::ShapeData::MULTI_POINT:
      return model::MultiPoint{
          DecodePositions(in.getMultiPoint(), data.Field("multiPoint"), 1, faults)};
    case wire::ShapeData::LINE_STRING:
      return model::LineString{
          DecodePositions(in.getLineString(), data.Field("lineString"), kLinePositionsMin, faults)};
    case wire::ShapeData::MULTI_LINE_STRING: {
      const auto lines = in.getMultiLineString();
      const Path path = data.Field("multiLineString");
      if (!LongEnough(faults, path, lines.size(), 1, "lines")) return {};
      return model::MultiLineString{DecodeLines(lines, path, kLinePositionsMin, faults)};
    }
    case wire::ShapeData::POLYGON:
      return DecodePolygon(in.getPolygon(), data.Field("polygon"), faults);
    case wire::ShapeData::MULTI_POLYGON: {
      const auto polygons = in.getMultiPolygon();
      const Path path = data.Field("multiPolygon");
      if (!LongEnough(faults, path, polygons.size(), 1, "polygons")) return {};
      model::MultiPolygon out;
      for (unsigned i = 0; i < polygons.size() && !faults.rejected(); ++i) {
        out.polygons.push_back(DecodePolygon(polygons[i], path.Item(i), faults));
      }
      return out;
    }
  }
  return {};
}

/// The name of a member that is a null pointer, or nothing.
std::string_view NullMember(wire::ShapeData::Reader in) {
  switch (in.which()) {
    case wire::ShapeData::POINT:
      return in.hasPoint() ? "" : "point";
    case wire::ShapeData::MULTI_POINT:
      return in.hasMultiPoint() ? "" : "multiPoint";
    case wire::ShapeData::LINE_STRING:
      return in.hasLineString() ? "" : "lineString";
    case wire::ShapeData::MULTI_LINE_STRING:
      return in.hasMultiLineString() ? "" : "multiLineString";
    case wire::ShapeData::POLYGON:
      return in.hasPolygon() ? "" : "polygon";
    case wire::ShapeData::MULTI_POLYGON:
      return in.hasMultiPolygon() ? "" : "multiPolygon";
  }
  return "";
}

model::ShapeData DecodeData(wire::ShapeData::Reader in, const Path& path, Faults& faults) {
  const std::string_view null_member = NullMember(in);
  if (!null_member.empty()) {
    faults.Content(MissingField(path.Field(null_member), "is a null pointer"));
    return {};
  }
  if (!SizeIsGood(in, path, faults)) return {};
  return DecodeMember(in, path, faults);
}

model::AssetIdentity DecodeIdentity(wire::AssetIdentity::Reader in, const Path& path,
                                    Faults& faults) {
  return {.id = RequiredText(faults, path.Field("id"), View(in.getId()), kIdBytesMax),
          .name = DurableText(faults, path.Field("name"), View(in.getName()), kNameBytesMax),
          .rev = in.getRev(),
          .hash = DurableText(faults, path.Field("hash"), View(in.getHash()), kIdBytesMax)};
}

model::ReportedShape DecodeUpsert(wire::ReportedShape::Reader in, const Path& path,
                                  Faults& faults) {
  model::ReportedShape out;
  if (in.hasData()) {
    out.data = DecodeData(in.getData(), path.Field("data"), faults);
  } else {
    faults.Content(MissingField(path.Field("data"), "is a null pointer"));
  }
  if (in.hasIdentity()) {
    out.identity = DecodeIdentity(in.getIdentity(), path.Field("identity"), faults);
  } else {
    faults.Content(MissingField(path.Field("identity"), "is a null pointer"));
  }
  out.area_type = Enum<model::ReportedLayerRole>(faults, in.getAreaType());
  out.scope = Enum<model::ScopeType>(faults, in.getScope());
  out.expire_time_ms = Time(faults, in.getExpireTimeMs());
  out.min_z_m = Finite(faults, path.Field("minZM"), in.getMinZM()).value_or(0);
  out.max_z_m = Finite(faults, path.Field("maxZM"), in.getMaxZM()).value_or(0);
  // Both 0, no bounds, passes as well.
  if (out.min_z_m > out.max_z_m) {
    faults.Content(MinAboveMax(path.Field("minZM"), out.min_z_m, out.max_z_m));
  }
  out.level_id = in.getLevelId();
  return out;
}

std::optional<model::Trajectory> DecodeTrajectory(wire::Object::Reader in, const Path& path,
                                                  Faults& faults) {
  if (!in.hasTrajectory()) return std::nullopt;
  const auto trajectory = in.getTrajectory();
  const auto finite = [&](std::string_view name, double value) {
    return Finite(faults, path.Field(name), value).value_or(0);
  };
  return model::Trajectory{
      .speed_mps = finite("speedMps", trajectory.getSpeedMps()),
      .course_deg = finite("courseDeg", trajectory.getCourseDeg()),
      .vertical_rate_mps = finite("verticalRateMps", trajectory.getVerticalRateMps())};
}

model::Object DecodeUpsert(wire::Object::Reader in, const Path& path, Faults& faults) {
  model::Object out;
  out.id = RequiredText(faults, path.Field("id"), View(in.getId()), kIdBytesMax);
  out.name = DurableText(faults, path.Field("name"), View(in.getName()), kNameBytesMax);
  out.unix_time_ms = Time(faults, in.getUnixTimeMs());
  out.expires_unix_time_ms = Time(faults, in.getExpiresUnixTimeMs());
  out.scope = Enum<model::ScopeType>(faults, in.getScope());
  out.object_type = Enum<model::ObjectType>(faults, in.getObjectType());
  const Path location = path.Field("location");
  if (in.hasLocation()) {
    out.location = JudgePose(faults, location, Raw(in.getLocation())).value_or(model::Pose());
  } else {
    faults.Content(MissingField(location, "is a null pointer"));
  }
  out.trajectory = DecodeTrajectory(in, path.Field("trajectory"), faults);
  out.radius_m = NotNegative(faults, path.Field("radiusM"), in.getRadiusM()).value_or(0);
  return out;
}

/// Both operations look alike: an upsert whose struct must be there, or an id to delete.
template <typename Out, typename In>
Out DecodeOp(In in, Faults& faults) {
  const Path root;
  switch (in.which()) {
    case In::Reads::UPSERT: {
      const Path path = root.Field("upsert");
      if (!in.hasUpsert()) {
        faults.Content(MissingField(path, "is a null pointer"));
        return {};
      }
      return Out{DecodeUpsert(in.getUpsert(), path, faults)};
    }
    case In::Reads::DELETE:
      return Out{model::Deletion{
          RequiredText(faults, root.Field("delete"), View(in.getDelete()), kIdBytesMax)}};
  }
  faults.Content(UnknownVariant(root, static_cast<unsigned>(in.which())));
  return {};
}

}  // namespace

model::ShapeOp DecodeShape(wire::ReportedShapeOp::Reader in, Faults& faults) {
  return DecodeOp<model::ShapeOp>(in, faults);
}

model::ObjectOp DecodeObject(wire::ObjectOp::Reader in, Faults& faults) {
  return DecodeOp<model::ObjectOp>(in, faults);
}

}  // namespace uplink::schema
