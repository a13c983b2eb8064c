#include "tools/uplink-fleet/robot/forwarded_item.h"

#include <utility>

#include <fmt/core.h>

#include "schema/model/layer_role.h"
#include "tools/uplink-fleet/robot/rows.h"

namespace uplink::synthetic {

namespace {

std::string_view NameOf(nexus_command::ItemKind kind) {
  switch (kind) {
    case nexus_command::ItemKind::kShape:
      return "shape";
    case nexus_command::ItemKind::kObject:
      break;
  }
  return "object";
}

}  // namespace

std::string Shown(const ItemName& item) { return fmt::format("{} {}", NameOf(item.kind), item.id); }

bool IsOf(const ItemName& item, std::string_view ruri) {
  return nexus_command::OriginalId(item.id, ruri).has_value();
}

std::uint64_t FingerprintOf(v1::Shape row) {
  row = Bare(std::move(row));
  row.clear_id();
  row.clear_expires_at();
  return HashOf(row);
}

std::uint64_t FingerprintOf(v1::TrackedObject row) {
  row = Bare(std::move(row));
  row.clear_id();
  return HashOf(row);
}

std::uint64_t FingerprintOf(const nexus_command::Shape& shape) {
  v1::Shape row = RowOf(model::ReportedShape{.identity = shape.identity,
                                             .data = shape.data,
                                             .area_type = {},
                                             .scope = shape.scope,
                                             .expire_time_ms = 0,
                                             .min_z_m = shape.min_z_m,
                                             .max_z_m = shape.max_z_m,
                                             .level_id = shape.level_id});
  row.set_area_type(model::EnumText(shape.area_type));
  return FingerprintOf(std::move(row));
}

std::uint64_t FingerprintOf(const model::Object& object) { return FingerprintOf(RowOf(object)); }

}  // namespace uplink::synthetic
