#include "server/robot/live_parts.h"

#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace uplink::robot {
namespace {

using storage::LivePart;

TEST(LiveParts, EachLiveVariantHasAPartOfItsOwnAndDurableOnesHaveNone) {
  std::set<LivePart> parts;
  for (std::size_t i = 0; i < model::kVariants; ++i) {
    const auto variant = static_cast<model::Variant>(i);
    const std::optional<LivePart> part = PartOfVariant(variant);
    EXPECT_NE(part.has_value(), model::IsDurable(variant)) << model::ToText(variant);
    if (!part) continue;
    EXPECT_TRUE(parts.insert(*part).second) << model::ToText(variant);
  }
  // RCAN's Robot State is no variant.
  EXPECT_EQ(parts.size(), storage::kLivePartKinds - 1);
  EXPECT_FALSE(parts.contains(LivePart::kRcan));
}

TEST(LiveParts, EveryRowOfTheTableIsVisitedInOrder) {
  std::vector<std::size_t> seen;
  ForEachPart([&]<typename Tag>(Tag /*row*/) { seen.push_back(Tag::kIndex); });
  ASSERT_EQ(seen.size(), storage::kLivePartKinds);
  for (std::size_t i = 0; i < seen.size(); ++i) EXPECT_EQ(seen[i], i);
}

TEST(LiveParts, AMessageGetsIntoItsPartUnderItsKey) {
  LiveParts parts;
  model::SystemHealth health;
  health.device_id = "main";
  EXPECT_EQ(PutInto(parts, health), 0U);
  model::ConsumableStatus consumable;
  consumable.kind = "paint";
  consumable.tank_id = "left";
  EXPECT_EQ(PutInto(parts, consumable), 0U);
  model::MotionTelemetry motion;
  motion.unix_time_ms = 7;
  EXPECT_EQ(PutInto(parts, motion), 0U);
  EXPECT_NE(parts.health.Find("main"), nullptr);
  EXPECT_NE(parts.consumables.Find("paint/left"), nullptr);
  ASSERT_TRUE(parts.motion);
  EXPECT_EQ(parts.motion->unix_time_ms, 7);
  EXPECT_FALSE(parts.status);
}

TEST(LivePartsDeathTest, ADurableMessageIsAMistakeOfOurs) {
  LiveParts parts;
  EXPECT_DEATH(PutInto(parts, model::Message{}), "only live kinds are applied");
}

}  // namespace
}  // namespace uplink::robot
