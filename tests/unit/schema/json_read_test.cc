#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "schema/json/exact.h"
#include "schema/json/read.h"
#include "schema/json/text.h"

/// What stores keep as text comes back as it was.
namespace uplink::json {
namespace {

/// Geometries of all kinds, odd ones included, from one seed.
class Drawer final {
 public:
  explicit Drawer(std::uint64_t seed) : random_(seed) {}

  std::size_t Below(std::size_t end) { return random_() % end; }

  /// Mostly an angle with all its bits; at times one of few values, so that positions are equal.
  double Number() {
    if (Below(3) == 0)
      return std::vector<double>{0, -0.0, 1, 5e-324, 1.7976931348623157e308}[Below(5)];
    return std::uniform_real_distribution<double>(-180, 180)(random_);
  }
  model::GeoPoint2 Position() { return {.lon = Number(), .lat = Number()}; }
  model::Positions Positions() {
    model::Positions positions(Below(6));
    for (model::GeoPoint2& position : positions) position = Position();
    return positions;
  }
  model::Positions Ring() {
    model::Positions ring = Positions();
    if (!ring.empty() && Below(2) == 0) ring.push_back(ring.front());
    return ring;
  }
  model::PolygonData Polygon() {
    model::PolygonData polygon{.exterior = Ring(), .holes = {}};
    for (std::size_t holes = Below(4); holes > 0; --holes) polygon.holes.push_back(Ring());
    return polygon;
  }
  model::ShapeData Geometry() {
    const std::size_t items = Below(4);
    switch (Below(6)) {
      case 0:
        return Position();
      case 1:
        return model::MultiPoint{Positions()};
      case 2:
        return model::LineString{Positions()};
      case 3: {
        model::MultiLineString data;
        for (std::size_t i = 0; i < items; ++i) data.lines.push_back(Positions());
        return data;
      }
      case 4:
        return Polygon();
      default: {
        model::MultiPolygon data;
        for (std::size_t i = 0; i < items; ++i) data.polygons.push_back(Polygon());
        return data;
      }
    }
  }

 private:
  std::mt19937_64 random_;
};

bool ComesBack(const model::ShapeData& data) {
  const auto read = ReadGeometry(GeometryText(data));
  return read.ok() && *read == data;
}

TEST(ReadGeometryTest, GivesBackEveryGeometryAsItWasSent) {
  for (std::uint64_t seed = 0; seed < 5000; ++seed) {
    Drawer drawer(seed);
    const model::ShapeData data = drawer.Geometry();
    EXPECT_TRUE(ComesBack(data)) << "seed " << seed << ": " << GeometryText(data);
  }
}

TEST(ReadGeometryTest, GivesBackRingsThatAreHardlyRings) {
  const model::GeoPoint2 a{1, 2};
  const model::GeoPoint2 b{3, 4};
  for (const model::Positions& ring :
       {model::Positions{}, {a}, {a, a}, {a, b}, {a, b, a}, {a, b, b}, {a, a, a}, {a, a, b}}) {
    EXPECT_TRUE(ComesBack(model::PolygonData{ring, {ring, ring}})) << ring.size();
    EXPECT_TRUE(ComesBack(model::MultiPolygon{{{ring, {}}, {ring, {ring}}}})) << ring.size();
  }
  EXPECT_TRUE(ComesBack(model::MultiPolygon{}));
  EXPECT_TRUE(ComesBack(model::MultiPoint{}));
  EXPECT_TRUE(ComesBack(model::MultiLineString{{{}}}));
}

/// Rows of an earlier build do not say which rings were open.
TEST(ReadGeometryTest, TakesRingsAsClosedWhereNothingIsSaid) {
  const auto read = ReadGeometry(R"({"type":"Polygon","coordinates":[[[1,2],[3,4],[1,2]]]})");
  ASSERT_TRUE(read.ok());
  EXPECT_TRUE(*read == model::ShapeData(model::PolygonData{{{1, 2}, {3, 4}, {1, 2}}, {}}));
}

TEST(ReadGeometryTest, RefusesWhatIsNotWrittenSo) {
  const std::string ring = R"("coordinates":[[[1,2],[3,4],[1,2]]])";
  for (const std::string& text : std::vector<std::string>{
           "",
           "1",
           "{}",
           "{",
           R"({"type":"Point"})",
           R"({"coordinates":[1,2]})",
           R"({"type":"Circle","coordinates":[1,2]})",
           R"({"type":"Point","coordinates":[1]})",
           R"({"type":"Point","coordinates":[1,2,3]})",
           R"({"type":"Point","coordinates":[1,"2"]})",
           R"({"type":"Point","coordinates":1})",
           R"({"type":"Point","coordinates":[1,2]} {})",
           R"({"type":"Polygon","coordinates":[]})",
           R"({"type":"LineString","coordinates":[[[1,2]]]})",
           R"({"type":"Polygon","openRings":0,)" + ring + "}",
           R"({"type":"Polygon","openRings":[1],)" + ring + "}",
           R"({"type":"Polygon","openRings":[-1],)" + ring + "}",
           R"({"type":"Polygon","openRings":[0,0],)" + ring + "}",
           R"({"type":"Polygon","openRings":[0.5],)" + ring + "}",
           R"({"type":"Polygon","openRings":[0],"coordinates":[[[1,2],[1,2]]]})",
           R"({"type":"Polygon","openRings":[0],"coordinates":[[[1,2],[3,4],[5,6]]]})",
           R"({"type":"Point","openRings":[0],"coordinates":[1,2]})"}) {
    EXPECT_EQ(ReadGeometry(text).status().code(), absl::StatusCode::kDataLoss) << text;
  }
  EXPECT_TRUE(ReadGeometry(R"({"type":"Polygon","openRings":[0],)" + ring + "}").ok());
}

TEST(ReadPoseTest, GivesBackWhatWasWritten) {
  Drawer drawer(1);
  for (int i = 0; i < 2000; ++i) {
    model::Pose pose{.lat_deg = drawer.Number(), .lon_deg = drawer.Number()};
    if (drawer.Below(2) == 0) pose.altitude_m = drawer.Number();
    if (drawer.Below(2) == 0) pose.heading_deg = drawer.Number();
    const auto read = ReadPose(Text(pose));
    ASSERT_TRUE(read.ok());
    EXPECT_TRUE(*read == pose) << Text(pose);
  }
}

TEST(ReadPoseTest, RefusesWhatIsNoPose) {
  EXPECT_TRUE(ReadPose(R"({"latDeg":1,"lonDeg":2})").ok());
  EXPECT_FALSE(ReadPose(R"({"latDeg":1})").ok());
  EXPECT_FALSE(ReadPose(R"({"latDeg":1,"lonDeg":"2"})").ok());
  EXPECT_FALSE(ReadPose(R"({"latDeg":1,"lonDeg":2,"altitudeM":null})").ok());
  EXPECT_FALSE(ReadPose("[]").ok());
  EXPECT_FALSE(ReadPose("").ok());
}

TEST(ReadTrajectoryTest, GivesBackWhatWasWritten) {
  Drawer drawer(2);
  for (int i = 0; i < 2000; ++i) {
    const model::Trajectory trajectory{.speed_mps = drawer.Number(),
                                       .course_deg = drawer.Number(),
                                       .vertical_rate_mps = drawer.Number()};
    const auto read = ReadTrajectory(Text(trajectory));
    ASSERT_TRUE(read.ok());
    EXPECT_TRUE(*read == trajectory) << Text(trajectory);
  }
}

TEST(ReadTrajectoryTest, RefusesWhatIsNoTrajectory) {
  EXPECT_FALSE(ReadTrajectory(R"({"speedMps":1,"courseDeg":2})").ok());
  EXPECT_FALSE(ReadTrajectory("null").ok());
}

/// Every bit of a double, whatever its size: Boost's own reader misses some.
TEST(ParseExactTest, GivesTheNearestDouble) {
  std::mt19937_64 random(3);
  int finite = 0;
  for (int i = 0; i < 20'000; ++i) {
    const std::uint64_t bits = random();
    double number = 0;
    std::memcpy(&number, &bits, sizeof(number));
    if (number - number != 0) continue;  // NaN and infinity have no JSON
    ++finite;
    const auto read = ParseExact(boost::json::serialize(boost::json::value(number)));
    ASSERT_TRUE(read.has_value());
    EXPECT_EQ(NumberOf(*read), number);
  }
  EXPECT_GT(finite, 10'000);
}

TEST(ParseExactTest, ReadsAllElseAsBoostDoes) {
  const std::string text =
      R"({"a":[1,-2,18446744073709551615,true,false,null,"x\ny\u00e9"],"b":{"c":{}},"":[]})";
  EXPECT_EQ(ParseExact(text), boost::json::parse(text));
  EXPECT_EQ(NumberOf(*ParseExact("18446744073709551615")), 18446744073709551615.0);
  EXPECT_EQ(NumberOf(*ParseExact("\"1\"")), std::nullopt);
  for (const char* bad : {"", " ", "{\"a\":1", "1 2", "nul", "[1,]", "\"\xff\""}) {
    EXPECT_FALSE(ParseExact(bad).has_value()) << bad;
  }
}

}  // namespace
}  // namespace uplink::json
