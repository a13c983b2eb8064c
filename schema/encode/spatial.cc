#include "schema/encode/spatial.h"

#include <variant>

namespace uplink::schema {
namespace {

using PositionsBuilder = capnp::List<wire::GeoPoint2>::Builder;

void EncodePositions(const model::Positions& in, PositionsBuilder out) {
  for (unsigned i = 0; i < out.size(); ++i) {
    out[i].setLon(in[i].lon);
    out[i].setLat(in[i].lat);
  }
}

void EncodeLines(const std::vector<model::Positions>& in,
                 capnp::List<capnp::List<wire::GeoPoint2>>::Builder out) {
  for (unsigned i = 0; i < out.size(); ++i) EncodePositions(in[i], out.init(i, Count(in[i])));
}

void EncodePolygon(const model::PolygonData& in, wire::PolygonData::Builder out) {
  EncodePositions(in.exterior, out.initExterior(Count(in.exterior)));
  EncodeLines(in.holes, out.initHoles(Count(in.holes)));
}

/// Writes one geometry; one overload an alternative.
struct GeometryEncoder {
  wire::ShapeData::Builder out;

  void operator()(const model::GeoPoint2& in) {
    auto point = out.initPoint();
    point.setLon(in.lon);
    point.setLat(in.lat);
  }
  void operator()(const model::MultiPoint& in) {
    EncodePositions(in.points, out.initMultiPoint(Count(in.points)));
  }
  void operator()(const model::LineString& in) {
    EncodePositions(in.points, out.initLineString(Count(in.points)));
  }
  void operator()(const model::MultiLineString& in) {
    EncodeLines(in.lines, out.initMultiLineString(Count(in.lines)));
  }
  void operator()(const model::PolygonData& in) { EncodePolygon(in, out.initPolygon()); }
  void operator()(const model::MultiPolygon& in) {
    auto polygons = out.initMultiPolygon(Count(in.polygons));
    for (unsigned i = 0; i < polygons.size(); ++i) EncodePolygon(in.polygons[i], polygons[i]);
  }
};

}  // namespace

void EncodeIdentity(const model::AssetIdentity& in, const std::string& id,
                    wire::AssetIdentity::Builder out) {
  out.setId(Text(id));
  out.setName(Text(in.name));
  out.setRev(in.rev);
  out.setHash(Text(in.hash));
}

void EncodeGeometry(const model::ShapeData& in, wire::ShapeData::Builder out) {
  std::visit(GeometryEncoder{out}, in);
}

void EncodeObject(const model::Object& in, const std::string& id, wire::Object::Builder out) {
  out.setId(Text(id));
  out.setName(Text(in.name));
  out.setUnixTimeMs(in.unix_time_ms);
  out.setExpiresUnixTimeMs(in.expires_unix_time_ms);
  out.setScope(Enum<wire::ScopeType>(in.scope));
  out.setObjectType(Enum<wire::ObjectType>(in.object_type));
  EncodePose(in.location, out.initLocation());
  if (in.trajectory) {
    auto trajectory = out.initTrajectory();
    trajectory.setSpeedMps(in.trajectory->speed_mps);
    trajectory.setCourseDeg(in.trajectory->course_deg);
    trajectory.setVerticalRateMps(in.trajectory->vertical_rate_mps);
  }
  out.setRadiusM(in.radius_m);
}

void EncodeMember(const model::ShapeOp& in, wire::UplinkMsg::Builder message) {
  auto out = message.initShape();
  if (in.upsert() != nullptr) {
    const model::ReportedShape& shape = *in.upsert();
    auto upsert = out.initUpsert();
    EncodeArea(shape, in.id(), upsert);
    upsert.setAreaType(Enum<wire::ReportedLayerRole>(shape.area_type));
    upsert.setExpireTimeMs(shape.expire_time_ms);
  } else {
    out.setDelete(Text(in.id()));
  }
}

void EncodeMember(const model::ObjectOp& in, wire::UplinkMsg::Builder message) {
  auto out = message.initObject();
  if (in.upsert() != nullptr) {
    EncodeObject(*in.upsert(), in.id(), out.initUpsert());
  } else {
    out.setDelete(Text(in.id()));
  }
}

}  // namespace uplink::schema
