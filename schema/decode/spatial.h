#pragma once

#include "schema/decode/decode.h"
#include "schema/decode/fields.h"
#include "schema/limits.h"
#include "schema/model/spatial.h"
#include "schema/rules/describe.h"
#include "schema/rules/numbers.h"
#include "schema/rules/texts.h"

/// What messages from robots and commands to them share. As in decode.h, what is read is judged,
/// and kj::Exception may be thrown.
namespace uplink::schema {

// decode/geometry.cc
[[nodiscard]] model::ShapeData DecodeGeometry(wire::ShapeData::Reader in, const Path& path,
                                              Violations& violations);
// decode/spatial.cc
[[nodiscard]] model::AssetIdentity DecodeIdentity(wire::AssetIdentity::Reader in, const Path& path,
                                                  Violations& violations);

/// What an area that a robot reports and one that a robot receives have in common.
template <typename Out, typename In>
[[nodiscard]] Out DecodeArea(In in, const Path& path, Violations& violations) {
  Out out;
  if (in.hasData()) {
    out.data = DecodeGeometry(in.getData(), path.Field("data"), violations);
  } else {
    violations.Content(MissingField(path.Field("data"), "is a null pointer"));
  }
  if (in.hasIdentity()) {
    out.identity = DecodeIdentity(in.getIdentity(), path.Field("identity"), violations);
  } else {
    violations.Content(MissingField(path.Field("identity"), "is a null pointer"));
  }
  out.area_type = Enum<decltype(out.area_type)>(violations, in.getAreaType());
  out.scope = Enum<model::ScopeType>(violations, in.getScope());
  out.min_z_m = Finite(violations, path.Field("minZM"), in.getMinZM()).value_or(0);
  out.max_z_m = Finite(violations, path.Field("maxZM"), in.getMaxZM()).value_or(0);
  // Both 0, no bounds, passes as well.
  if (out.min_z_m > out.max_z_m) {
    violations.Content(MinAboveMax(path.Field("minZM"), out.min_z_m, out.max_z_m));
  }
  out.level_id = in.getLevelId();
  return out;
}

/// All operations look alike: an upsert whose struct must be there, or an id to delete.
/// `decode_upsert` reads that struct.
template <typename Op, typename In, typename DecodeUpsert>
[[nodiscard]] Op DecodeOp(In in, Violations& violations, DecodeUpsert decode_upsert) {
  const Path root;
  switch (in.which()) {
    case In::Reads::UPSERT: {
      const Path path = root.Field("upsert");
      if (!in.hasUpsert()) {
        violations.Content(MissingField(path, "is a null pointer"));
        return {};
      }
      return Op{decode_upsert(in.getUpsert(), path, violations)};
    }
    case In::Reads::DELETE:
      return Op{model::Deletion{
          RequiredText(violations, root.Field("delete"), View(in.getDelete()), kIdBytesMax)}};
  }
  violations.Content(UnknownVariant(root, static_cast<unsigned>(in.which())));
  return {};
}

}  // namespace uplink::schema
