// What a message holds in memory, beside what its texts and lists say of themselves.
#include "schema/model/held_bytes.h"

#include <string>

#include <gtest/gtest.h>

namespace uplink::model {
namespace {

/// What each allocation costs besides.
constexpr std::size_t kAllocation = 16;
std::size_t Text(std::size_t bytes) { return bytes + 1 + kAllocation; }

TEST(HeldBytes, NumbersAndShortTextsHoldNothing) {
  MotionTelemetry motion;
  motion.pose = Pose();
  EXPECT_EQ(HeldBytes(Body(motion)), 0U);
  Fault fault;
  fault.fault_id = std::string(15, 'x');
  EXPECT_EQ(HeldBytes(Body(fault)), 0U);
  fault.fault_id = std::string(16, 'x');
  EXPECT_EQ(HeldBytes(Body(fault)), Text(16));
}

TEST(HeldBytes, EveryTextOfAMessageCounts) {
  Fault fault;
  fault.fault_id = std::string(100, 'a');
  fault.source = std::string(200, 'b');
  fault.category = std::string(300, 'c');
  fault.description = std::string(400, 'd');
  fault.suggested_action = std::string(500, 'e');
  EXPECT_EQ(HeldBytes(Body(fault)), Text(100) + Text(200) + Text(300) + Text(400) + Text(500));
  MissionRunStatus run;
  run.status_message = std::string(4096, 'x');
  EXPECT_EQ(HeldBytes(Body(run)), Text(4096));
  EventTelemetry event;
  event.kind =
      FaultRaisedEvent{.fault_code = std::string(50, 'x'), .description = std::string(60, 'y')};
  EXPECT_EQ(HeldBytes(Body(event)), Text(50) + Text(60));
  event.kind = NamedEvent{.kind = std::string(20, 'x'), .detail_json = std::string(30, 'y')};
  EXPECT_EQ(HeldBytes(Body(event)), Text(20) + Text(30));
  const ScopeUpdate update{.id = std::string(36, 'i'),
                           .type = std::string(40, 't'),
                           .detail_json = std::string(90, 'd')};
  EXPECT_EQ(HeldBytes(update), Text(36) + Text(40) + Text(90));
  const Message message{.message = std::string(70, 'x'), .detail_json = std::string(80, 'y')};
  EXPECT_EQ(HeldBytes(Body(message)), Text(70) + Text(80));
}

TEST(HeldBytes, PositionsCountInEveryGeometry) {
  const Positions ring(1000);
  const std::size_t positions = 1000 * sizeof(GeoPoint2) + kAllocation;
  ReportedShape shape;
  shape.data = LineString{ring};
  EXPECT_EQ(HeldBytes(Body(ShapeOp{shape})), positions);
  shape.data = PolygonData{.exterior = ring, .holes = {ring, ring}};
  EXPECT_EQ(HeldBytes(Body(ShapeOp{shape})), 3 * positions + 2 * sizeof(Positions) + kAllocation);
  shape.identity.name = std::string(256, 'x');
  shape.data = MultiPolygon{{PolygonData{.exterior = ring}, PolygonData{.exterior = ring}}};
  EXPECT_EQ(HeldBytes(Body(ShapeOp{shape})),
            2 * positions + 2 * sizeof(PolygonData) + kAllocation + Text(256));
}

TEST(HeldBytes, AListCountsItsPlacesAndWhatTheyHold) {
  CurrentSettings settings;
  settings.settings = {{.key = std::string(40, 'k'), .value = std::string(70, 'v')},
                       {.key = "short", .value = 1.0}};
  EXPECT_EQ(HeldBytes(Body(settings)),
            2 * sizeof(SettingUpdate) + kAllocation + Text(40) + Text(70));
}

TEST(HeldBytes, ARejectionHoldsItsTexts) {
  EXPECT_EQ(HeldBytes(Rejection{.field = std::string(30, 'f'), .detail = std::string(90, 'd')}),
            Text(30) + Text(90));
}

}  // namespace
}  // namespace uplink::model
