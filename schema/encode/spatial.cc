#include <variant>

#include "schema/encode/encode_body.h"

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

void EncodeShape(const model::ReportedShape& in, wire::ReportedShape::Builder out) {
  auto identity = out.initIdentity();
  identity.setId(Text(in.identity.id));
  identity.setName(Text(in.identity.name));
  identity.setRev(in.identity.rev);
  identity.setHash(Text(in.identity.hash));
  std::visit(GeometryEncoder{out.initData()}, in.data);
  out.setAreaType(Enum<wire::ReportedLayerRole>(in.area_type));
  out.setScope(Enum<wire::ScopeType>(in.scope));
  out.setExpireTimeMs(in.expire_time_ms);
  out.setMinZM(in.min_z_m);
  out.setMaxZM(in.max_z_m);
  out.setLevelId(in.level_id);
}

void EncodeObject(const model::Object& in, wire::Object::Builder out) {
  out.setId(Text(in.id));
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

}  // namespace

void EncodeMember(const model::ShapeOp& in, wire::UplinkMsg::Builder message) {
  auto out = message.initShape();
  if (in.upsert() != nullptr) {
    EncodeShape(*in.upsert(), out.initUpsert());
  } else {
    out.setDelete(Text(in.id()));
  }
}

void EncodeMember(const model::ObjectOp& in, wire::UplinkMsg::Builder message) {
  auto out = message.initObject();
  if (in.upsert() != nullptr) {
    EncodeObject(*in.upsert(), out.initUpsert());
  } else {
    out.setDelete(Text(in.id()));
  }
}

}  // namespace uplink::schema
