#pragma once

#include <string>

#include "schema/encode/encode_body.h"

/// Parts that messages from robots and commands to them share: encode/spatial.cc.
namespace uplink::schema {

void EncodeIdentity(const model::AssetIdentity& in, const std::string& id,
                    wire::AssetIdentity::Builder out);
void EncodeGeometry(const model::ShapeData& in, wire::ShapeData::Builder out);
/// The whole object under that id, which need not be its own.
void EncodeObject(const model::Object& in, const std::string& id, wire::Object::Builder out);

/// All of a shape that ReportedShape and Shape share, under that id: not role, not expiry.
template <typename Out>
void EncodeArea(const model::ReportedShape& in, const std::string& id, Out out) {
  EncodeIdentity(in.identity, id, out.initIdentity());
  EncodeGeometry(in.data, out.initData());
  out.setScope(Enum<wire::ScopeType>(in.scope));
  out.setMinZM(in.min_z_m);
  out.setMaxZM(in.max_z_m);
  out.setLevelId(in.level_id);
}

}  // namespace uplink::schema
