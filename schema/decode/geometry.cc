#include <string_view>
#include <vector>

#include <capnp/any.h>

#include "schema/decode/fields.h"
#include "schema/decode/message.h"
#include "schema/decode/spatial.h"
#include "schema/limits.h"
#include "schema/rules/describe.h"
#include "schema/rules/spatial.h"

/// Geometries: positions are counted before any is read.
namespace uplink::schema {
namespace {

using WirePositions = capnp::List<wire::GeoPoint2>::Reader;
using WireLines = capnp::List<capnp::List<wire::GeoPoint2>>::Reader;

/// Whether each element of the list, which is not empty, has a word of data at least.
bool HasData(const WirePositions& positions) {
  return capnp::AnyStruct::Reader(positions[0]).getDataSection().size() >= kWordBytes;
}

/// Counts lines, rings and positions of one shape; stops the walk at the first bound passed.
class ShapeSize {
 public:
  ShapeSize(Violations& violations, const Path& path) : violations_(violations), path_(path) {}

  [[nodiscard]] bool AddParts(std::size_t parts) {
    parts_ += parts;
    if (parts_ <= kShapePartsMax) return true;
    violations_.Reject(TooManyItems(path_, parts_, kShapePartsMax, "lines or rings"));
    return false;
  }
  [[nodiscard]] bool AddPositions(const WirePositions& positions) {
    positions_ += positions.size();
    if (positions_ > kShapePositionsMax) {
      violations_.Reject(TooManyItems(path_, positions_, kShapePositionsMax, "positions"));
      return false;
    }
    // Without a word for each a few bytes would stand for thousands. The canonical form of a single
    // position at 0, 0 has none.
    if (positions.size() <= 1 || HasData(positions)) return true;
    violations_.Reject(PositionsWithoutData(path_, positions.size()));
    return false;
  }
  [[nodiscard]] bool AddLines(const WireLines& lines) {
    if (!AddParts(lines.size())) return false;
    for (const auto line : lines) {
      if (!AddPositions(line)) return false;
    }
    return true;
  }
  [[nodiscard]] bool AddPolygon(wire::PolygonData::Reader polygon) {
    return AddParts(1) && AddPositions(polygon.getExterior()) && AddLines(polygon.getHoles());
  }

 private:
  Violations& violations_;
  const Path& path_;
  std::size_t parts_ = 0;
  std::size_t positions_ = 0;
};

bool SizeIsGood(wire::ShapeData::Reader in, const Path& path, Violations& violations) {
  ShapeSize size(violations, path);
  switch (in.which()) {
    case wire::ShapeData::POINT:
      return true;
    case wire::ShapeData::MULTI_POINT:
      return size.AddPositions(in.getMultiPoint());
    case wire::ShapeData::LINE_STRING:
      return size.AddPositions(in.getLineString());
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
  violations.Reject(UnknownVariant(path, static_cast<unsigned>(in.which())));
  return false;
}

bool LongEnough(Violations& violations, const Path& path, std::size_t count, std::size_t min,
                std::string_view what) {
  if (count >= min) return true;
  violations.Content(TooFewItems(path, count, min, what));
  return false;
}

model::Positions DecodePositions(const WirePositions& in, const Path& path, std::size_t min,
                                 Violations& violations) {
  model::Positions out;
  if (!LongEnough(violations, path, in.size(), min, "positions")) return out;
  out.reserve(in.size());
  for (unsigned i = 0; i < in.size() && !violations.rejected(); ++i) {
    out.push_back(
        JudgePosition(violations, path.Item(i), {.lon = in[i].getLon(), .lat = in[i].getLat()}));
  }
  return out;
}

std::vector<model::Positions> DecodeLines(const WireLines& in, const Path& path, std::size_t min,
                                          Violations& violations) {
  std::vector<model::Positions> out;
  out.reserve(in.size());
  for (unsigned i = 0; i < in.size() && !violations.rejected(); ++i) {
    out.push_back(DecodePositions(in[i], path.Item(i), min, violations));
  }
  return out;
}

model::PolygonData DecodePolygon(wire::PolygonData::Reader in, const Path& path,
                                 Violations& violations) {
  return {.exterior = DecodePositions(in.getExterior(), path.Field("exterior"), kRingPositionsMin,
                                      violations),
          .holes = DecodeLines(in.getHoles(), path.Field("holes"), kRingPositionsMin, violations)};
}

/// The member of a shape whose size was found good.
model::ShapeData DecodeMember(wire::ShapeData::Reader in, const Path& data,
                              Violations& violations) {
  switch (in.which()) {
    case wire::ShapeData::POINT:
      return JudgePosition(violations, data.Field("point"),
                           {.lon = in.getPoint().getLon(), .lat = in.getPoint().getLat()});
    case wire::ShapeData::MULTI_POINT:
      return model::MultiPoint{
          DecodePositions(in.getMultiPoint(), data.Field("multiPoint"), 1, violations)};
    case wire::ShapeData::LINE_STRING:
      return model::LineString{DecodePositions(in.getLineString(), data.Field("lineString"),
                                               kLinePositionsMin, violations)};
    case wire::ShapeData::MULTI_LINE_STRING: {
      const auto lines = in.getMultiLineString();
      const Path path = data.Field("multiLineString");
      if (!LongEnough(violations, path, lines.size(), 1, "lines")) return {};
      return model::MultiLineString{DecodeLines(lines, path, kLinePositionsMin, violations)};
    }
    case wire::ShapeData::POLYGON:
      return DecodePolygon(in.getPolygon(), data.Field("polygon"), violations);
    case wire::ShapeData::MULTI_POLYGON: {
      const auto polygons = in.getMultiPolygon();
      const Path path = data.Field("multiPolygon");
      if (!LongEnough(violations, path, polygons.size(), 1, "polygons")) return {};
      model::MultiPolygon out;
      for (unsigned i = 0; i < polygons.size() && !violations.rejected(); ++i) {
        out.polygons.push_back(DecodePolygon(polygons[i], path.Item(i), violations));
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

}  // namespace

model::ShapeData DecodeGeometry(wire::ShapeData::Reader in, const Path& path,
                                Violations& violations) {
  const std::string_view null_member = NullMember(in);
  if (!null_member.empty()) {
    violations.Content(MissingField(path.Field(null_member), "is a null pointer"));
    return {};
  }
  if (!SizeIsGood(in, path, violations)) return {};
  return DecodeMember(in, path, violations);
}

}  // namespace uplink::schema
