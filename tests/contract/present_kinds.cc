#include "tests/contract/present_kinds.h"

#include "storage/bounds.h"
#include "storage/refusal.h"

namespace uplink::testing {
namespace {

template <typename Row, typename SeenOf>
absl::StatusOr<storage::Page<PresentSeen>> SeenPage(absl::StatusOr<storage::Page<Row>> page,
                                                    const SeenOf& seen_of) {
  if (!page.ok()) return page.status();
  storage::Page<PresentSeen> seen;
  seen.next_token = page->next_token;
  for (const Row& row : page->rows) seen.rows.push_back(seen_of(row));
  return seen;
}

PresentKind ShapeKind() {
  return {"shapes",
          storage::kShapesPerRobotMax,
          [](const PresentUpsert& upsert) {
            model::ReportedShape shape;
            shape.identity.id = upsert.id;
            shape.identity.name = upsert.name;
            shape.data = model::GeoPoint2{8, 47};
            shape.expire_time_ms = upsert.expires_at_ms;
            return model::ShapeOp{shape};
          },
          [](const std::string& id) { return model::ShapeOp{model::Deletion{id}}; },
          [](storage::Reader& reader, const storage::PresentQuery& query) {
            return SeenPage(reader.Shapes(query), [](const storage::ShapeRow& row) {
              return PresentSeen{row.robot, row.identity.id, row.identity.name, row.expires_at_ms,
                                 row.received_at};
            });
          },
          storage::TooManyShapes};
}

PresentKind ObjectKind() {
  return {"objects",
          storage::kObjectsPerRobotMax,
          [](const PresentUpsert& upsert) {
            model::Object object;
            object.id = upsert.id;
            object.name = upsert.name;
            object.expires_unix_time_ms = upsert.expires_at_ms;
            return model::ObjectOp{object};
          },
          [](const std::string& id) { return model::ObjectOp{model::Deletion{id}}; },
          [](storage::Reader& reader, const storage::PresentQuery& query) {
            return SeenPage(reader.Objects(query), [](const storage::ObjectRow& row) {
              return PresentSeen{row.robot, row.id, row.name, row.expires_at_ms, row.received_at};
            });
          },
          storage::TooManyObjects};
}

}  // namespace

std::array<PresentKind, 2> PresentKinds() { return {ShapeKind(), ObjectKind()}; }

}  // namespace uplink::testing
