// What the store's rows become on the wire.
#include "server/forward/frames.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/json/text.h"
#include "schema/nexus_command/decode.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::forward {
namespace {

using ::testing::HasSubstr;

constexpr nexus_command::CommandId kCommand = {1, 2,  3,  4,  5,  6,  7,  8,
                                               9, 10, 11, 12, 13, 14, 15, 16};
constexpr std::string_view kOrigin = "rcan://a/1";

v1::Forward ForwardOf(const EncodedFrame& frame) {
  v1::RelayResponse response;
  EXPECT_TRUE(response.ParseFromString(*frame));
  EXPECT_EQ(response.frame_case(), v1::RelayResponse::kForward);
  return response.forward();
}

nexus_command::Command CommandOf(const EncodedFrame& frame) {
  const v1::Forward forward = ForwardOf(frame);
  EXPECT_EQ(forward.kind(), v1::FORWARD_KIND_COMMAND);
  EXPECT_EQ(forward.origin_ruri(), kOrigin);
  auto command = nexus_command::Decode(forward.nexus_command());
  EXPECT_TRUE(command.ok()) << command.status();
  return command.ok() ? *command : nexus_command::Command{};
}

/// As the store has it, of what a robot reported.
storage::SharedItem RowOf(const model::ReportedShape& shape) {
  storage::ShapeRow row;
  row.robot.ruri = kOrigin;
  row.identity = shape.identity;
  row.area_type = shape.area_type;
  row.scope = shape.scope;
  row.geometry_json = json::GeometryText(shape.data);
  row.min_z_m = shape.min_z_m;
  row.max_z_m = shape.max_z_m;
  row.level_id = shape.level_id;
  row.expires_at_ms = 77;
  return {row};
}

model::ReportedShape Hazard() {
  const model::Positions open = {{1.1, 2.2}, {3.3, 4.4}, {5.5, 6.6}, {7.7, 8.8}};
  const model::Positions closed = {{1.5, 2.5}, {2.5, 2.5}, {2.5, 3.5}, {1.5, 2.5}};
  return {.identity = {.id = "pit", .name = "The pit", .rev = 7, .hash = "h4sh"},
          .data = model::PolygonData{.exterior = open, .holes = {closed}},
          .area_type = model::ReportedLayerRole::kHazard,
          .scope = model::ScopeType::kWorld,
          .min_z_m = -1.25,
          .max_z_m = 3.5,
          .level_id = -2};
}

TEST(FramesTest, MarksAreFramesWithoutACommand) {
  EXPECT_EQ(ForwardOf(SnapshotBegin()).kind(), v1::FORWARD_KIND_SNAPSHOT_BEGIN);
  EXPECT_EQ(ForwardOf(SnapshotEnd()).kind(), v1::FORWARD_KIND_SNAPSHOT_END);
  EXPECT_EQ(ForwardOf(SnapshotEnd()).nexus_command(), "");
}

TEST(FramesTest, AShapeKeepsAllButItsId) {
  const model::ReportedShape hazard = Hazard();
  const auto frame = UpsertFrame(RowOf(hazard), kCommand);
  ASSERT_TRUE(frame.ok()) << frame.status();
  const nexus_command::Command command = CommandOf(*frame);
  EXPECT_EQ(command.id, kCommand);
  const auto* shape = std::get_if<nexus_command::Shape>(&command.what);
  ASSERT_NE(shape, nullptr);
  EXPECT_EQ(shape->identity.id, "pit@rcan://a/1");
  EXPECT_EQ(shape->identity.name, "The pit");
  EXPECT_EQ(shape->identity.rev, 7U);
  EXPECT_EQ(shape->identity.hash, "h4sh");
  EXPECT_EQ(shape->data, hazard.data) << "an open ring stays open";
  EXPECT_EQ(shape->area_type, model::LayerRole::kHazard);
  EXPECT_EQ(shape->scope, model::ScopeType::kWorld);
  EXPECT_EQ(shape->min_z_m, -1.25);
  EXPECT_EQ(shape->max_z_m, 3.5);
  EXPECT_EQ(shape->level_id, -2);
}

TEST(FramesTest, AnObjectKeepsAllButItsIdAndSaysWhenItEnds) {
  model::Object object = {
      .id = "dog",
      .name = "Rex",
      .unix_time_ms = 5,
      .expires_unix_time_ms = 99,
      .scope = model::ScopeType::kFleet,
      .object_type = model::ObjectType::kAnimal,
      .location = {.lat_deg = 1.25, .lon_deg = 2.5, .altitude_m = 3, .heading_deg = 4},
      .trajectory = model::Trajectory{1, 2, 3},
      .radius_m = 0.5};
  storage::ObjectRow row;
  row.robot.ruri = kOrigin;
  row.id = object.id;
  row.name = object.name;
  row.object_type = object.object_type;
  row.scope = object.scope;
  row.location_json = json::Text(object.location);
  row.trajectory_json = json::Text(*object.trajectory);
  row.radius_m = object.radius_m;
  row.sampled_at_ms = object.unix_time_ms;
  row.expires_at_ms = object.expires_unix_time_ms;
  const auto frame = UpsertFrame({row}, kCommand);
  ASSERT_TRUE(frame.ok()) << frame.status();
  object.id = "dog@rcan://a/1";
  const nexus_command::Command command = CommandOf(*frame);
  EXPECT_EQ(std::get<model::Object>(command.what), object);

  row.trajectory_json.clear();
  object.trajectory.reset();
  const auto without = UpsertFrame({row}, kCommand);
  ASSERT_TRUE(without.ok()) << without.status();
  EXPECT_EQ(std::get<model::Object>(CommandOf(*without).what), object);
}

TEST(FramesTest, ADeletionNamesTheForwardedIdByItsKind) {
  const ItemKey shape{storage::PresentKind::kShape, std::string(kOrigin), "pit"};
  EXPECT_EQ(std::get<nexus_command::ShapeDeletion>(CommandOf(DeleteFrame(shape, kCommand)).what).id,
            "pit@rcan://a/1");
  const ItemKey object{storage::PresentKind::kObject, std::string(kOrigin), "dog"};
  EXPECT_EQ(
      std::get<nexus_command::ObjectDeletion>(CommandOf(DeleteFrame(object, kCommand)).what).id,
      "dog@rcan://a/1");
}

TEST(FramesTest, AnIdThatHoldsAnAddressIsTakenApartByTheFramesOrigin) {
  constexpr const char* kId = "pit@rcan://b/2";
  model::ReportedShape hazard = Hazard();
  hazard.identity.id = kId;
  const auto upsert = UpsertFrame(RowOf(hazard), kCommand);
  ASSERT_TRUE(upsert.ok()) << upsert.status();
  const auto told = std::get<nexus_command::Shape>(CommandOf(*upsert).what).identity.id;
  EXPECT_EQ(nexus_command::OriginalId(told, ForwardOf(*upsert).origin_ruri()), kId);
  const EncodedFrame end =
      DeleteFrame({storage::PresentKind::kShape, std::string(kOrigin), kId}, kCommand);
  EXPECT_EQ(std::get<nexus_command::ShapeDeletion>(CommandOf(end).what).id, told);
}

TEST(FramesTest, ARowThatIsNoGeometryIsAnError) {
  storage::SharedItem item = RowOf(Hazard());
  std::get<storage::ShapeRow>(item.row).geometry_json = R"({"type":"Blob"})";
  EXPECT_FALSE(UpsertFrame(item, kCommand).ok());
  storage::ObjectRow object;
  object.location_json = "nowhere";
  EXPECT_FALSE(UpsertFrame({object}, kCommand).ok());
}

TEST(FramesTest, WhatAFrameHasAtLeastIsKnownFromItsGeometry) {
  model::ReportedShape shape = Hazard();
  for (const std::size_t points : {1U, 2U, 100U, 8'000U}) {
    shape.data = model::PolygonData{.exterior = model::Positions(points, {1.5, 2.5})};
    const storage::SharedItem row = RowOf(shape);
    const auto frame = UpsertFrame(row, kCommand);
    ASSERT_TRUE(frame.ok()) << frame.status();
    EXPECT_LE(LeastFrameBytes(row), (*frame)->size()) << points;
    EXPECT_GT(4 * LeastFrameBytes(row), 16 * points) << points;
  }
  EXPECT_LE(LeastFrameBytes(RowOf(Hazard())), (*UpsertFrame(RowOf(Hazard()), kCommand))->size());
}

}  // namespace
}  // namespace uplink::forward
