// Joints by source type and name, and the names that have no room.
#include "server/cyberwave/joint_table.h"

#include <string>

#include <gtest/gtest.h>

#include "schema/limits.h"

namespace uplink::cyberwave {
namespace {

model::cyberwave::Joint JointAt(const std::string& name, double position) {
  return {.name = name, .position = position};
}

std::vector<model::cyberwave::Joint> Names(std::size_t from, std::size_t to) {
  std::vector<model::cyberwave::Joint> joints;
  for (std::size_t i = from; i < to; ++i) joints.push_back(JointAt("j" + std::to_string(i), 1));
  return joints;
}

TEST(JointTableTest, PastItsNamesFurtherOnesAreDroppedAndKnownOnesGoOn) {
  JointTable table;
  EXPECT_EQ(table.Take(Names(0, kJointNamesMax), {}).applied, kJointNamesMax);
  const JointTable::Taken taken = table.Take(Names(kJointNamesMax - 1, kJointNamesMax + 20), {});
  EXPECT_EQ(taken.applied, 1U);
  EXPECT_EQ(taken.without_room, 20U);
  ASSERT_EQ(taken.dropped.size(), schema::kDroppedFieldsListedMax);
  EXPECT_EQ(taken.dropped[0].reason, model::RejectReason::kTooManyItems);
  EXPECT_NE(taken.dropped[0].field.find("j256"), std::string::npos) << taken.dropped[0].field;
  EXPECT_NE(taken.dropped[0].detail.find("256"), std::string::npos) << taken.dropped[0].detail;
  EXPECT_EQ(table.Of(JointGroup::kEdge).size(), kJointNamesMax);
  EXPECT_EQ(table.Take(Names(900, 901), {.group = JointGroup::kLeader}).applied, 1U)
      << "each source type has its own names";
}

TEST(JointTableTest, OfOneMessageSomeJointsMayBeLate) {
  JointTable table;
  SaidJoints said;
  said.stamp.timestamp_us = 100;
  (void)table.Take({JointAt("a", 1)}, said);
  said.stamp.timestamp_us = 99;
  const JointTable::Taken taken = table.Take({JointAt("a", 2), JointAt("b", 2)}, said);
  EXPECT_EQ(taken.applied, 1U);
  EXPECT_EQ(taken.superseded, 1U);
  EXPECT_EQ(table.Of(JointGroup::kEdge).at("a").position, 1);
  EXPECT_EQ(table.Of(JointGroup::kEdge).at("b").position, 2);
}

TEST(JointTableTest, AJointWithoutAValueTakesNoName) {
  JointTable table;
  EXPECT_EQ(table.Take({{.name = "a"}}, {}).applied, 1U);
  EXPECT_TRUE(table.Of(JointGroup::kEdge).empty());
}

TEST(JointTableTest, EverySourceOfStateHasItsGroup) {
  using enum model::cyberwave::SourceType;
  EXPECT_EQ(JointGroupOf(kEdge), JointGroup::kEdge);
  EXPECT_EQ(JointGroupOf(kUnknown), JointGroup::kEdge);
  EXPECT_EQ(JointGroupOf(kEdgeLeader), JointGroup::kLeader);
  EXPECT_EQ(JointGroupOf(kEdgeFollower), JointGroup::kFollower);
  EXPECT_EQ(JointGroupOf(kSim), JointGroup::kSim);
  for (const auto command : {kTele, kSimTele, kEdit, kPreview}) {
    EXPECT_FALSE(JointGroupOf(command).has_value());
  }
}

}  // namespace
}  // namespace uplink::cyberwave
