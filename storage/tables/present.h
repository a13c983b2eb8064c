#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "schema/json/text.h"
#include "schema/model/spatial.h"
#include "storage/commit_record.h"
#include "storage/present.h"
#include "storage/rows.h"
#include "storage/tables/reports.h"
#include "storage/tables/table.h"

// What is present by key: faults that are active, shapes and objects.
namespace uplink::storage {

/// How a table of what is present differs from the others where entries are found, counted and
/// deleted.
struct PresentTable {
  std::string_view name;
  std::string_view id_column;
  /// Empty if the id alone is the key of a robot's row.
  std::string_view source_column;
  /// When a row expires; empty: never.
  std::string_view expiry_column;
};
/// In the order of PresentKind.
inline constexpr std::array<PresentTable, kPresentKinds> kPresentTables = {{
    {"faults_active", "fault_id", "source", ""},
    {"shapes", "id", "", "expires_ms"},
    {"objects", "id", "", "expires_ms"},
}};

/// An upsert of an entry that is present, the last of its batch where that writes each once. The
/// pointers lead into the batch.
template <typename Body>
struct Upserted {
  const CommitRecord* record = nullptr;
  const Body* body = nullptr;
  /// The effective one, Unix milliseconds; 0: never.
  std::int64_t expires_ms = 0;
  /// Of the upsert that made the entry present, if the batch did.
  SystemTime first_at;
  Entry entry;
};

using RaisedFault = Upserted<model::Fault>;
using UpsertedShape = Upserted<model::ReportedShape>;
using UpsertedObject = Upserted<model::Object>;

/// raised_at and entry are those of the raise that made the fault active. Each raise clears what an
/// operator acknowledged.
inline constexpr Table<RaisedFault, FaultRow, 15> kFaultsActiveTable = {
    "faults_active",
    Writes::kUpserts,
    {"raised_at",
     [](SystemTime time, FaultRow& row) {
       row.raised_at = time;
       row.fault.active = true;
     }},
    Join(
        std::array<Column<RaisedFault, FaultRow>, 5>{
            kRobotRuri.Key(),
            kRobotFleet,
            Col("raised_at", [](const auto& row) { return row.first_at; }).Kept(),
            kRowEntry.Kept(),
            kArrival<&FaultRow::received_at>,
        },
        Join(kFaultColumns<RaisedFault>,
             std::array<Column<RaisedFault, FaultRow>, 3>{
                 Col<&FaultRow::acknowledged_at>(
                     "acknowledged_at",
                     [](const auto& /*row*/) { return std::optional<SystemTime>(); }),
                 Col<&FaultRow::acknowledged_by>(
                     "acknowledged_by", [](const auto& /*row*/) { return std::string_view(); }),
                 Col<&FaultRow::acknowledged_note>(
                     "acknowledged_note", [](const auto& /*row*/) { return std::string_view(); }),
             }))};

// Where shapes and objects keep what both have.
template <typename Shape>
constexpr auto* IdOf(Shape& item) {
  if constexpr (requires { item.identity; }) {
    return &item.identity.id;
  } else {
    return &item.id;
  }
}
template <typename Shape>
constexpr auto* NameOf(Shape& item) {
  if constexpr (requires { item.identity; }) {
    return &item.identity.name;
  } else {
    return &item.name;
  }
}

/// The columns of both. first_at and entry are those of the upsert that made the id present.
template <typename In, typename Out>
inline constexpr std::array<Column<In, Out>, 9> kSpatialColumns = {{
    kRobotRuri.Key(),
    Same("id", [](auto& item) { return IdOf(item); }).Key(),
    kRobotFleet,
    Col("first_at", [](const auto& row) { return row.first_at; }).Kept(),
    kRowEntry.Kept(),
    kArrival<&Out::received_at>,
    Col<&Out::expires_at_ms>("expires_ms", [](const auto& row) { return row.expires_ms; }),
    Same("name", [](auto& item) { return NameOf(item); }),
    Same("scope", [](auto& item) { return &item.scope; }),
}};

/// Lists stand by the upsert that made the id present, which their rows do not show.
template <typename Out>
constexpr Listed<Out> ByFirstUpsert() {
  return {"first_at", nullptr};
}

inline constexpr Table<UpsertedShape, ShapeRow, 16> kShapesTable = {
    "shapes", Writes::kUpserts, ByFirstUpsert<ShapeRow>(),
    Join(kSpatialColumns<UpsertedShape, ShapeRow>,
         std::array<Column<UpsertedShape, ShapeRow>, 7>{
             Same("rev", [](auto& shape) { return &shape.identity.rev; }),
             Same("hash", [](auto& shape) { return &shape.identity.hash; }),
             Same("area_type", [](auto& shape) { return &shape.area_type; }),
             Same("min_z_m", [](auto& shape) { return &shape.min_z_m; }),
             Same("max_z_m", [](auto& shape) { return &shape.max_z_m; }),
             Same("level_id", [](auto& shape) { return &shape.level_id; }),
             Col<&ShapeRow::geometry_json>(
                 "geometry", [](const auto& row) { return json::GeometryText(row.body->data); }),
         })};

inline std::optional<std::string> TrajectoryText(const model::Object& object) {
  if (!object.trajectory) return std::nullopt;
  return json::Text(*object.trajectory);
}

inline constexpr Table<UpsertedObject, ObjectRow, 14> kObjectsTable = {
    "objects", Writes::kUpserts, ByFirstUpsert<ObjectRow>(),
    Join(kSpatialColumns<UpsertedObject, ObjectRow>,
         std::array<Column<UpsertedObject, ObjectRow>, 5>{
             Col<&ObjectRow::sampled_at_ms>("sampled_ms",
                                            [](const auto& row) { return row.body->unix_time_ms; }),
             Same("object_type", [](auto& object) { return &object.object_type; }),
             Same("radius_m", [](auto& object) { return &object.radius_m; }),
             Col<&ObjectRow::location_json>(
                 "location", [](const auto& row) { return json::Text(row.body->location); }),
             Col<&ObjectRow::trajectory_json>(
                 "trajectory", [](const auto& row) { return TrajectoryText(*row.body); }),
         })};

}  // namespace uplink::storage
