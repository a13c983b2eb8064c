#include <limits>
#include <string>
#include <variant>
#include <vector>

#include <gmock/gmock.h>

#include "schema/json/text.h"
#include "tests/contract/present_contract.h"
#include "tests/unit/schema/samples.h"

/// What a row of a shape and of an object holds.
namespace uplink::testing {
namespace {

using ::testing::SizeIs;

TEST_P(PresentContract, KeepsEveryFieldOfAShape) {
  Open();
  model::ReportedShape shape = test::SampleShape();
  shape.identity.rev = std::numeric_limits<std::uint32_t>::max();
  shape.area_type = static_cast<model::ReportedLayerRole>(77);
  shape.scope = static_cast<model::ScopeType>(88);
  shape.expire_time_ms = kNowMs + 5;
  shape.min_z_m = -1.1;
  shape.level_id = std::numeric_limits<std::int32_t>::min();
  Commit({At(3, Good(1, model::ShapeOp{shape}))});
  const auto rows = Shapes();
  ASSERT_THAT(rows, SizeIs(1));
  EXPECT_EQ(rows[0].robot, *robot_);
  EXPECT_EQ(rows[0].identity, shape.identity);
  EXPECT_EQ(rows[0].area_type, shape.area_type);
  EXPECT_EQ(rows[0].scope, shape.scope);
  EXPECT_EQ(rows[0].geometry_json, json::GeometryText(shape.data));
  EXPECT_EQ(rows[0].expires_at_ms, kNowMs + 5);
  EXPECT_EQ(rows[0].min_z_m, -1.1);
  EXPECT_EQ(rows[0].max_z_m, shape.max_z_m);
  EXPECT_EQ(rows[0].level_id, shape.level_id);
  EXPECT_EQ(rows[0].received_at, Time(3));
}

TEST_P(PresentContract, KeepsAGeometryOfEachTypeWithItsRingsClosed) {
  Open();
  const model::Positions open = {{8, 47}, {8.5, 47}, {8.5, 47.5}};
  const std::vector<model::ShapeData> data = {
      model::GeoPoint2{8.25, 47.5},     model::MultiPoint{open},
      model::LineString{open},          model::MultiLineString{{open, open}},
      model::PolygonData{open, {open}}, model::MultiPolygon{{{open, {}}, {open, {open}}}}};
  ASSERT_EQ(data.size(), std::variant_size_v<model::ShapeData>);
  for (std::size_t i = 0; i < data.size(); ++i) {
    model::ReportedShape shape = test::SampleShape();
    shape.identity.id = "s" + std::to_string(i);
    shape.data = data[i];
    Commit({Good(i + 1, model::ShapeOp{shape})});
    EXPECT_EQ(Shapes().at(0).geometry_json, json::GeometryText(data[i]));
  }
  EXPECT_EQ(
      Shapes().at(1).geometry_json,
      R"({"type":"Polygon","coordinates":[[[8E0,4.7E1],[8.5E0,4.7E1],[8.5E0,4.75E1],)"
      R"([8E0,4.7E1]],[[8E0,4.7E1],[8.5E0,4.7E1],[8.5E0,4.75E1],[8E0,4.7E1]]],"openRings":[0,1]})");
}

TEST_P(PresentContract, KeepsEveryFieldOfAnObject) {
  Open();
  model::Object object = test::SampleObject();
  object.object_type = static_cast<model::ObjectType>(77);
  object.scope = static_cast<model::ScopeType>(88);
  object.radius_m = 0.1;
  model::Object bare;
  bare.id = "bare";
  bare.location = {1, 2, {}, {}};
  Commit({At(3, Good(1, model::ObjectOp{object})), At(4, Good(2, model::ObjectOp{bare}))});
  const auto rows = Objects();
  ASSERT_THAT(rows, SizeIs(2));
  EXPECT_EQ(rows[1].robot, *robot_);
  EXPECT_EQ(rows[1].id, object.id);
  EXPECT_EQ(rows[1].name, object.name);
  EXPECT_EQ(rows[1].object_type, object.object_type);
  EXPECT_EQ(rows[1].scope, object.scope);
  EXPECT_EQ(rows[1].location_json, json::Text(object.location));
  EXPECT_EQ(rows[1].trajectory_json, json::Text(*object.trajectory));
  EXPECT_EQ(rows[1].radius_m, 0.1);
  EXPECT_EQ(rows[1].sampled_at_ms, object.unix_time_ms);
  EXPECT_EQ(rows[1].expires_at_ms, object.expires_unix_time_ms);
  EXPECT_EQ(rows[1].received_at, Time(3));
  EXPECT_EQ(rows[0].location_json, json::Text(bare.location));
  EXPECT_EQ(rows[0].trajectory_json, "");
  EXPECT_EQ(rows[0].sampled_at_ms, 0);
}

TEST_P(PresentContract, ReplacesAllOfAnId) {
  Open();
  model::ReportedShape shape = test::SampleShape();
  model::Object object = test::SampleObject();
  Commit({Good(1, model::ShapeOp{shape}), Good(2, model::ObjectOp{object})});
  shape = {.identity = {.id = shape.identity.id, .name = "", .rev = 0, .hash = ""},
           .data = model::GeoPoint2{1, 2}};
  object = {.id = object.id, .location = {3, 4, {}, {}}};
  Commit({At(8, Good(3, model::ShapeOp{shape})), At(9, Good(4, model::ObjectOp{object}))});
  ASSERT_THAT(Shapes(), SizeIs(1));
  const storage::ShapeRow shape_row = Shapes()[0];
  EXPECT_EQ(shape_row.identity, shape.identity);
  EXPECT_EQ(shape_row.area_type, shape.area_type);
  EXPECT_EQ(shape_row.scope, shape.scope);
  EXPECT_EQ(shape_row.geometry_json, json::GeometryText(shape.data));
  EXPECT_EQ(shape_row.expires_at_ms, 0);
  EXPECT_EQ(shape_row.min_z_m, 0);
  EXPECT_EQ(shape_row.max_z_m, 0);
  EXPECT_EQ(shape_row.level_id, 0);
  EXPECT_EQ(shape_row.received_at, Time(8));
  ASSERT_THAT(Objects(), SizeIs(1));
  const storage::ObjectRow object_row = Objects()[0];
  EXPECT_EQ(object_row.name, "");
  EXPECT_EQ(object_row.object_type, object.object_type);
  EXPECT_EQ(object_row.scope, object.scope);
  EXPECT_EQ(object_row.location_json, json::Text(object.location));
  EXPECT_EQ(object_row.trajectory_json, "");
  EXPECT_EQ(object_row.radius_m, 0);
  EXPECT_EQ(object_row.sampled_at_ms, 0);
  EXPECT_EQ(object_row.received_at, Time(9));
}

}  // namespace
}  // namespace uplink::testing
