#include <string>
#include <utility>
#include <vector>

#include "schema/limits.h"
#include "tests/unit/schema/judging.h"
#include "tests/unit/schema/samples.h"

namespace uplink::test {
namespace {

using model::GeoPoint2;
using model::Positions;
using model::RejectReason;

schema::Judgement JudgeData(model::ShapeData data) {
  model::ReportedShape shape = SampleShape();
  shape.data = std::move(data);
  return JudgeBody(model::ShapeOp{shape});
}

Positions Points(std::size_t count) { return Positions(count, GeoPoint2{.lon = 8, .lat = 47}); }

TEST(ShapeTest, TakesEveryGeometryAtItsLeast) {
  const std::vector<model::ShapeData> geometries = {
      GeoPoint2{.lon = 8, .lat = 47},
      model::MultiPoint{Points(1)},
      model::LineString{Points(2)},
      model::MultiLineString{{Points(2)}},
      model::PolygonData{.exterior = Points(3), .holes = {}},
      model::MultiPolygon{{{.exterior = Points(3), .holes = {Points(3)}}}}};
  ASSERT_EQ(geometries.size(), std::variant_size_v<model::ShapeData>);
  for (const model::ShapeData& data : geometries) {
    SCOPED_TRACE(data.index());
    const schema::Judgement judgement = JudgeData(data);
    ExpectGood(judgement);
    EXPECT_TRUE(BodyOf<model::ShapeOp>(judgement).upsert()->data == data);
  }
}

TEST(ShapeTest, RejectsGeometriesWithTooFewPositionsOrParts) {
  const auto rejects = [](model::ShapeData data, const std::string& field) {
    ExpectRejected(JudgeData(std::move(data)), RejectReason::kTooFewItems, field);
  };
  rejects(model::MultiPoint{}, "upsert.data.multiPoint");
  rejects(model::LineString{Points(1)}, "upsert.data.lineString");
  rejects(model::MultiLineString{}, "upsert.data.multiLineString");
  rejects(model::MultiLineString{{Points(2), Points(1)}}, "upsert.data.multiLineString[1]");
  rejects(model::PolygonData{.exterior = Points(2), .holes = {}}, "upsert.data.polygon.exterior");
  rejects(model::PolygonData{.exterior = Points(3), .holes = {Points(3), Points(2)}},
          "upsert.data.polygon.holes[1]");
  rejects(model::MultiPolygon{}, "upsert.data.multiPolygon");
  rejects(model::MultiPolygon{{{.exterior = Points(3), .holes = {}}, {}}},
          "upsert.data.multiPolygon[1].exterior");
}

TEST(ShapeTest, HasUpTo8192Positions) {
  constexpr std::size_t kMax = schema::kShapePositionsMax;
  ExpectGood(JudgeData(model::MultiPoint{Points(kMax)}));
  ExpectGood(JudgeData(model::LineString{Points(kMax)}));
  ExpectGood(JudgeData(model::MultiLineString{{Points(kMax - 2), Points(2)}}));
  ExpectGood(JudgeData(model::PolygonData{.exterior = Points(kMax - 3), .holes = {Points(3)}}));
  const auto rejects = [](model::ShapeData data) {
    ExpectRejected(JudgeData(std::move(data)), RejectReason::kTooManyItems, "upsert.data");
  };
  rejects(model::MultiPoint{Points(kMax + 1)});
  rejects(model::LineString{Points(kMax + 1)});
  rejects(model::MultiLineString{{Points(kMax - 2), Points(3)}});
  rejects(model::PolygonData{.exterior = Points(kMax - 3), .holes = {Points(4)}});
  rejects(model::MultiPolygon{
      {{.exterior = Points(kMax - 3), .holes = {}}, {.exterior = Points(4), .holes = {}}}});
}

TEST(ShapeTest, HasUpTo256LinesOrRings) {
  constexpr std::size_t kMax = schema::kShapePartsMax;
  const auto lines = [](std::size_t count) {
    return model::MultiLineString{std::vector<Positions>(count, Points(2))};
  };
  const auto polygon = [](std::size_t holes) {
    return model::PolygonData{.exterior = Points(3),
                              .holes = std::vector<Positions>(holes, Points(3))};
  };
  const auto polygons = [&](std::size_t count, std::size_t holes) {
    return model::MultiPolygon{std::vector<model::PolygonData>(count, polygon(holes))};
  };
  ExpectGood(JudgeData(lines(kMax)));
  ExpectGood(JudgeData(polygon(kMax - 1)));
  ExpectGood(JudgeData(polygons(kMax, 0)));
  ExpectGood(JudgeData(polygons(kMax / 2, 1)));
  const auto rejects = [](model::ShapeData data) {
    ExpectRejected(JudgeData(std::move(data)), RejectReason::kTooManyItems, "upsert.data");
  };
  rejects(lines(kMax + 1));
  rejects(polygon(kMax));
  rejects(polygons(kMax + 1, 0));
  rejects(polygons(kMax / 2 + 1, 1));
}

TEST(ShapeTest, BoundsMayBeEqualOrBothZero) {
  model::ReportedShape shape = SampleShape();
  shape.min_z_m = shape.max_z_m = 2;
  ExpectGood(JudgeBody(model::ShapeOp{shape}));
  shape.min_z_m = shape.max_z_m = 0;
  ExpectGood(JudgeBody(model::ShapeOp{shape}));
  shape.max_z_m = -0.5;
  ExpectRejected(JudgeBody(model::ShapeOp{shape}), RejectReason::kOutOfRange, "upsert.minZM");
}

TEST(ShapeTest, RejectsAnUpperBoundThatIsNotFinite) {
  model::ReportedShape shape = SampleShape();
  shape.max_z_m = std::numeric_limits<double>::infinity();
  ExpectRejected(JudgeBody(model::ShapeOp{shape}), RejectReason::kNotFinite, "upsert.maxZM");
}

TEST(ShapeTest, KeepsRingsAsSent) {
  const model::PolygonData open{
      .exterior = {{.lon = 1, .lat = 1}, {.lon = 2, .lat = 1}, {.lon = 2, .lat = 2}}, .holes = {}};
  const schema::Judgement judgement = JudgeData(open);
  ExpectGood(judgement);
  EXPECT_TRUE(BodyOf<model::ShapeOp>(judgement).upsert()->data == model::ShapeData(open));
}

}  // namespace
}  // namespace uplink::test
