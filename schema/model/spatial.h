#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "schema/model/enum_text.h"
#include "schema/model/motion.h"

namespace uplink::model {

enum class ReportedLayerRole : std::uint16_t {
  kCoverage = 0,
  kOccupied = 1,
  kReserved = 2,
  kConsumed = 3,
  kHazard = 4,
  kBlocked = 5,
  kPlannedPath = 6,
};
template <>
inline constexpr auto kEnumNames<ReportedLayerRole> = std::to_array<std::string_view>(
    {"coverage", "occupied", "reserved", "consumed", "hazard", "blocked", "plannedPath"});

/// Robot and user stay with the fleet manager; fleet and world go to the fleet's other robots.
enum class ScopeType : std::uint16_t { kRobot = 0, kFleet = 1, kWorld = 2, kUser = 3 };
template <>
inline constexpr auto kEnumNames<ScopeType> = std::to_array<std::string_view>({"robot", "fleet",
                                                                               "world", "user"});

enum class ObjectType : std::uint16_t {
  kUnknown = 0,
  kPerson = 1,
  kAnimal = 2,
  kVehicle = 3,
  kRobot = 4,
  kStructure = 5,
  kEquipment = 6,
  kObstacle = 7,
  kDebris = 8,
  kHazard = 9,
  kMarker = 10,
  kPointOfInterest = 11,
};
template <>
inline constexpr auto kEnumNames<ObjectType> = std::to_array<std::string_view>(
    {"unknown", "person", "animal", "vehicle", "robot", "structure", "equipment", "obstacle",
     "debris", "hazard", "marker", "pointOfInterest"});

struct AssetIdentity {
  std::string id;
  std::string name;
  /// 0: not provided.
  std::uint32_t rev = 0;
  /// Empty: not provided.
  std::string hash;

  friend bool operator==(const AssetIdentity&, const AssetIdentity&) = default;
};

/// A position in degrees.
struct GeoPoint2 {
  double lon = 0;
  double lat = 0;

  friend bool operator==(const GeoPoint2&, const GeoPoint2&) = default;
};

using Positions = std::vector<GeoPoint2>;

struct MultiPoint {
  Positions points;

  friend bool operator==(const MultiPoint&, const MultiPoint&) = default;
};

struct LineString {
  Positions points;

  friend bool operator==(const LineString&, const LineString&) = default;
};

struct MultiLineString {
  std::vector<Positions> lines;

  friend bool operator==(const MultiLineString&, const MultiLineString&) = default;
};

/// Rings as they were sent, closed or not; what stores or shows them closes them.
struct PolygonData {
  Positions exterior;
  std::vector<Positions> holes;

  friend bool operator==(const PolygonData&, const PolygonData&) = default;
};

struct MultiPolygon {
  std::vector<PolygonData> polygons;

  friend bool operator==(const MultiPolygon&, const MultiPolygon&) = default;
};

/// A geometry; the alternatives stand in the order of the wire's union.
using ShapeData =
    std::variant<GeoPoint2, MultiPoint, LineString, MultiLineString, PolygonData, MultiPolygon>;

struct ReportedShape {
  AssetIdentity identity;
  ShapeData data;
  ReportedLayerRole area_type = ReportedLayerRole::kCoverage;
  ScopeType scope = ScopeType::kRobot;
  /// 0: never.
  std::int64_t expire_time_ms = 0;
  /// Metres; both 0: no vertical bounds.
  double min_z_m = 0;
  double max_z_m = 0;
  std::int32_t level_id = 0;

  friend bool operator==(const ReportedShape&, const ReportedShape&) = default;
};

/// The `delete` member of an operation.
struct Deletion {
  std::string id;

  friend bool operator==(const Deletion&, const Deletion&) = default;
};

/// A reported area, or the end of one. Durable. A value.
struct ShapeOp {
  std::variant<ReportedShape, Deletion> op;

  [[nodiscard]] const ReportedShape* upsert() const { return std::get_if<ReportedShape>(&op); }
  [[nodiscard]] const Deletion* deletion() const { return std::get_if<Deletion>(&op); }
  [[nodiscard]] const std::string& id() const {
    return upsert() != nullptr ? upsert()->identity.id : deletion()->id;
  }

  friend bool operator==(const ShapeOp&, const ShapeOp&) = default;
};

struct Trajectory {
  double speed_mps = 0;
  /// Clockwise from north.
  double course_deg = 0;
  double vertical_rate_mps = 0;

  friend bool operator==(const Trajectory&, const Trajectory&) = default;
};

struct Object {
  std::string id;
  std::string name;
  std::int64_t unix_time_ms = 0;
  /// 0: never.
  std::int64_t expires_unix_time_ms = 0;
  ScopeType scope = ScopeType::kRobot;
  ObjectType object_type = ObjectType::kUnknown;
  Pose location;
  std::optional<Trajectory> trajectory;
  double radius_m = 0;

  friend bool operator==(const Object&, const Object&) = default;
};

/// A tracked object, or the end of one. Durable. A value.
struct ObjectOp {
  std::variant<Object, Deletion> op;

  [[nodiscard]] const Object* upsert() const { return std::get_if<Object>(&op); }
  [[nodiscard]] const Deletion* deletion() const { return std::get_if<Deletion>(&op); }
  [[nodiscard]] const std::string& id() const {
    return upsert() != nullptr ? upsert()->id : deletion()->id;
  }

  friend bool operator==(const ObjectOp&, const ObjectOp&) = default;
};

}  // namespace uplink::model
