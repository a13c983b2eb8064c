#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "schema/limits.h"
#include "schema/nexus_command/decode.h"
#include "schema/nexus_command/encode.h"
#include "tests/unit/schema/samples.h"

/// What is encoded for robots, read back.
namespace uplink::nexus_command {
namespace {

constexpr std::string_view kOrigin = "rcan://local.rcan/acme/mower/1";
constexpr CommandId kId = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};

/// The command in these bytes, which must be good.
Command Decoded(std::string_view bytes) {
  absl::StatusOr<Command> command = Decode(bytes);
  if (!command.ok()) {
    ADD_FAILURE() << command.status();
    return {};
  }
  EXPECT_EQ(command->id, kId);
  return *std::move(command);
}

/// What robots must receive for this shape.
Shape Forwarded(const model::ReportedShape& reported) {
  Shape shape{.identity = reported.identity,
              .data = reported.data,
              .area_type = model::LayerRoleOf(reported.area_type),
              .scope = reported.scope,
              .min_z_m = reported.min_z_m,
              .max_z_m = reported.max_z_m,
              .level_id = reported.level_id};
  shape.identity.id = ForwardedId(reported.identity.id, kOrigin);
  return shape;
}

model::Object Forwarded(model::Object object) {
  object.id = ForwardedId(object.id, kOrigin);
  return object;
}

template <typename Reported>
void ExpectSame(const Reported& reported) {
  const Command command = Decoded(EncodeUpsert(kId, reported, kOrigin));
  EXPECT_TRUE(command.what == decltype(command.what)(Forwarded(reported)));
}

TEST(NexusCommandTest, KeepsEveryGeometryAsItWasSent) {
  const model::Positions open = {{8, 47}, {8.5, 47}, {8.5, 47.5}};
  const model::PolygonData polygon{open, {test::SampleRing(0.1), open}};
  const std::vector<model::ShapeData> geometries = {
      model::GeoPoint2{8.1, 47.2},
      model::MultiPoint{open},
      model::LineString{open},
      model::MultiLineString{{open, test::SampleRing()}},
      polygon,
      model::MultiPolygon{{polygon, {test::SampleRing(), {}}}}};
  for (const model::ShapeData& geometry : geometries) {
    SCOPED_TRACE(geometry.index());
    model::ReportedShape shape = test::SampleShape();
    shape.data = geometry;
    ExpectSame(shape);
  }
}

TEST(NexusCommandTest, KeepsEveryRoleAndScopeAlsoThoseWithoutAName) {
  for (const std::uint16_t number : std::to_array<std::uint16_t>({0, 1, 2, 3, 4, 5, 6, 7, 300})) {
    SCOPED_TRACE(number);
    model::ReportedShape shape = test::SampleShape();
    shape.area_type = static_cast<model::ReportedLayerRole>(number);
    shape.scope = static_cast<model::ScopeType>(number);
    ExpectSame(shape);
  }
}

TEST(NexusCommandTest, KeepsEveryTypeOfObject) {
  for (std::size_t number = 0; number <= model::kEnumNames<model::ObjectType>.size(); ++number) {
    SCOPED_TRACE(number);
    model::Object object = test::SampleObject();
    object.object_type = static_cast<model::ObjectType>(number);
    ExpectSame(object);
  }
}

TEST(NexusCommandTest, KeepsWhatAnObjectDoesNotSay) {
  model::Object object = test::SampleObject();
  object.trajectory.reset();
  object.location.altitude_m.reset();
  object.location.heading_deg.reset();
  object.expires_unix_time_ms = 0;
  ExpectSame(object);
}

TEST(NexusCommandTest, DeletesByTheForwardedId) {
  const auto deletion = [](ItemKind kind) {
    return Decoded(EncodeDelete(kId, kind, "a b", kOrigin)).what;
  };
  EXPECT_EQ(std::get<ShapeDeletion>(deletion(ItemKind::kShape)).id,
            "a b@rcan://local.rcan/acme/mower/1");
  EXPECT_EQ(std::get<ObjectDeletion>(deletion(ItemKind::kObject)).id,
            "a b@rcan://local.rcan/acme/mower/1");
}

/// An id as long as it may be kept, from a robot with the longest RURI.
TEST(NexusCommandTest, AForwardedIdIsTakenApartByItsOriginAlone) {
  for (const std::string_view id :
       {"pit", "", "@", "a@b", "a@rcan://x", "a@rcan://local.rcan/acme/mower/1", "rcan://x@"}) {
    for (const std::string_view origin : {kOrigin, std::string_view("rcan://x@rcan://y")}) {
      const std::string deletion = EncodeDelete(kId, ItemKind::kShape, id, origin);
      const std::string told = std::get<ShapeDeletion>(Decoded(deletion).what).id;
      EXPECT_EQ(OriginalId(told, origin), id) << told;
    }
  }
  // Two robots may share a forwarded id if one's name contains the other's.
  EXPECT_EQ(ForwardedId("a", "rcan://x@rcan://y"), ForwardedId("a@rcan://x", "rcan://y"));
  EXPECT_EQ(OriginalId("a@rcan://x@rcan://y", "rcan://y"), "a@rcan://x");
  EXPECT_EQ(OriginalId("a@rcan://x@rcan://y", "rcan://x@rcan://y"), "a");
  EXPECT_EQ(OriginalId("a@rcan://x", "rcan://y"), std::nullopt);
  EXPECT_EQ(OriginalId("arcan://x", "rcan://x"), std::nullopt);
  EXPECT_EQ(OriginalId("rcan://x", "rcan://x"), std::nullopt);
}

TEST(NexusCommandTest, HasRoomForTheLongestForwardedIdAndNoMore) {
  const std::string origin(model::kRuriBytesMax, 'r');
  model::Object object = test::SampleObject();
  object.id = std::string(schema::kIdBytesMax * kReplacementBytes, 'i');
  EXPECT_TRUE(Decode(EncodeUpsert(kId, object, origin)).ok());
  EXPECT_TRUE(Decode(EncodeDelete(kId, ItemKind::kObject, object.id, origin)).ok());
  object.id += 'i';
  EXPECT_FALSE(Decode(EncodeUpsert(kId, object, origin)).ok());
  EXPECT_FALSE(Decode(EncodeDelete(kId, ItemKind::kObject, object.id, origin)).ok());
}

/// As many rings and positions as one may have, with the longest texts.
TEST(NexusCommandTest, HasRoomForTheLargestShape) {
  constexpr std::size_t kEach = schema::kShapePositionsMax / schema::kShapePartsMax;
  const model::Positions ring(kEach, model::GeoPoint2{8, 47});
  model::ReportedShape shape = test::SampleShape();
  shape.data =
      model::MultiPolygon{std::vector<model::PolygonData>(schema::kShapePartsMax, {ring, {}})};
  shape.identity.id = std::string(schema::kIdBytesMax * kReplacementBytes, 'i');
  shape.identity.hash = shape.identity.id;
  shape.identity.name = std::string(schema::kNameBytesMax * kReplacementBytes, 'n');
  EXPECT_TRUE(Decode(EncodeUpsert(kId, shape, std::string(model::kRuriBytesMax, 'r'))).ok());
}

}  // namespace
}  // namespace uplink::nexus_command
