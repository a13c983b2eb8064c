// What receivers hold against what the server shows: what is missing, too much or other is found.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/view/timestamps.h"
#include "tools/uplink-fleet/compare/compare_forwards.h"
#include "tools/uplink-fleet/robot/forward_table.h"
#include "tools/uplink-fleet/robot/rows.h"

namespace uplink::synthetic {
namespace {

using ::testing::HasSubstr;

constexpr const char* kOne = "rcan://test/one";
constexpr const char* kTwo = "rcan://test/two";

model::ReportedShape Reported(model::ScopeType scope) {
  model::ReportedShape shape;
  shape.identity = {.id = "a", .name = "hole", .rev = 4, .hash = "h"};
  shape.data = model::PolygonData{.exterior = {{1, 2.1}, {3, 2}, {3, 4}}, .holes = {}};
  shape.area_type = model::ReportedLayerRole::kHazard;
  shape.scope = scope;
  shape.expire_time_ms = 77;
  shape.min_z_m = -0.1;
  shape.max_z_m = 2;
  shape.level_id = 3;
  return shape;
}

model::Object Seen() {
  model::Object object;
  object.id = "a";
  object.name = "dog";
  object.scope = model::ScopeType::kWorld;
  object.object_type = model::ObjectType::kAnimal;
  object.location.lat_deg = 47.1;
  object.trajectory = model::Trajectory{.speed_mps = 1, .course_deg = 2, .vertical_rate_mps = 0};
  object.expires_unix_time_ms = 99;
  return object;
}

template <typename Item>
auto Stored(const Item& item, const char* ruri) {
  auto row = RowOf(item);
  row.set_ruri(ruri);
  view::SetTimeMs(row, &decltype(row)::mutable_received_at, 5);
  return row;
}

/// Robots one and two share a shape of the same id, and two an object.
SharedItems Fleet() {
  const auto shape = Reported(model::ScopeType::kFleet);
  return SharedOf({Stored(shape, kOne), Stored(shape, kTwo)}, {Stored(Seen(), kTwo)});
}

/// What robot one was told by way of commands.
ReceiverTable TableOf(const std::vector<std::string>& commands) {
  ForwardReader reader;
  ForwardTable table(kOne, reader);
  v1::Forward forward;
  forward.set_kind(v1::FORWARD_KIND_SNAPSHOT_BEGIN);
  table.Take(forward);
  for (const std::string& command : commands) {
    forward.set_kind(v1::FORWARD_KIND_COMMAND);
    forward.set_origin_ruri(kTwo);
    forward.set_nexus_command(command);
    table.Take(forward);
  }
  forward.set_kind(v1::FORWARD_KIND_SNAPSHOT_END);
  table.Take(forward);
  EXPECT_EQ(table.violations(), 0U) << table.first_violation();
  return {kOne, table.whole(), table.Held()};
}

std::string ShapeCommand(const model::ReportedShape& shape) {
  return nexus_command::EncodeUpsert({1}, shape, kTwo);
}
std::string ObjectCommand(const model::Object& object) {
  return nexus_command::EncodeUpsert({1}, object, kTwo);
}

/// What differs; empty if all agrees.
std::string Difference(const ReceiverTable& table) {
  Findings findings;
  CompareForwards(Fleet(), {table}, findings);
  EXPECT_EQ(findings.Of(Thing::kForwardedItems).expected, 2U);
  EXPECT_EQ(findings.Of(Thing::kForwardedItems).found, table.held.size());
  if (findings.differences().empty()) return {};
  EXPECT_EQ(findings.differences().size(), 1U);
  return findings.differences()[0].expected + " | " + findings.differences()[0].found;
}

TEST(CompareForwards, ATableThatFollowedAgrees) {
  model::ReportedShape shape = Reported(model::ScopeType::kFleet);
  EXPECT_EQ(Difference(TableOf({ShapeCommand(shape), ObjectCommand(Seen())})), "");
  shape.expire_time_ms = 0;
  EXPECT_EQ(Difference(TableOf({ShapeCommand(shape), ObjectCommand(Seen())})), "")
      << "a shape's expiry is not told";
}

TEST(CompareForwards, AMissingItemIsFound) {
  EXPECT_THAT(Difference(TableOf({ObjectCommand(Seen())})),
              HasSubstr("shape a@rcan://test/two | not held"));
}

TEST(CompareForwards, AnItemThatNobodySharesIsFound) {
  model::ReportedShape ghost = Reported(model::ScopeType::kFleet);
  ghost.identity.id = "ghost";
  const auto table = TableOf({ShapeCommand(Reported(model::ScopeType::kFleet)), ShapeCommand(ghost),
                              ObjectCommand(Seen())});
  EXPECT_THAT(Difference(table), HasSubstr("shape ghost@rcan://test/two"));
}

TEST(CompareForwards, OtherContentsAreFound) {
  model::ReportedShape shape = Reported(model::ScopeType::kFleet);
  shape.level_id = 4;
  EXPECT_THAT(Difference(TableOf({ShapeCommand(shape), ObjectCommand(Seen())})),
              HasSubstr("shape a@rcan://test/two as the server shows it"));
  model::Object object = Seen();
  object.expires_unix_time_ms = 100;
  const auto table =
      TableOf({ShapeCommand(Reported(model::ScopeType::kFleet)), ObjectCommand(object)});
  EXPECT_THAT(Difference(table), HasSubstr("object a@rcan://test/two as the server shows it"));
}

TEST(CompareForwards, AStreamWithoutASnapshotIsFound) {
  ReceiverTable table =
      TableOf({ShapeCommand(Reported(model::ScopeType::kFleet)), ObjectCommand(Seen())});
  table.whole = false;
  EXPECT_THAT(Difference(table), HasSubstr("a snapshot on its stream | none"));
}

TEST(CompareForwards, OnlyFleetAndWorldAreShared) {
  using enum model::ScopeType;
  for (const auto& [scope, shared] : {std::pair(kRobot, 0U), std::pair(kUser, 0U),
                                      std::pair(kFleet, 1U), std::pair(kWorld, 1U)}) {
    EXPECT_EQ(SharedOf({Stored(Reported(scope), kOne)}, {}).size(), shared);
  }
}

TEST(CompareForwards, ViolationsAndForeignOriginsAreFound) {
  Findings findings;
  RobotOutcome robot;
  robot.ruri = kOne;
  CompareViolations(robot, findings);
  CompareOrigins({kOne, kTwo}, {kOne, kTwo}, findings);
  EXPECT_EQ(findings.differences_in_all(), 0U);
  robot.forward_violations = 3;
  robot.first_forward_violation = "it came back";
  CompareViolations(robot, findings);
  CompareOrigins({kOne, kTwo}, {kOne}, findings);
  EXPECT_EQ(findings.Of(Thing::kForwardViolations).found, 4U);
  ASSERT_EQ(findings.differences().size(), 2U);
  EXPECT_EQ(findings.differences()[0].found, "3; the first: it came back");
  EXPECT_EQ(findings.differences()[1].ruri, kTwo);
}

}  // namespace
}  // namespace uplink::synthetic
