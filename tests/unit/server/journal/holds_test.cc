#include "server/journal/holds.h"

#include <memory>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/journal/step_bench.h"

namespace uplink::journal {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

class HoldsTest : public ::testing::Test, protected StepBench {
 protected:
  std::shared_ptr<RecordingClient> robot_ = std::make_shared<RecordingClient>("rcan://a");
};

TEST_F(HoldsTest, ARobotThatIsHeldStaysWhenItsOwnerLetsGoOfIt) {
  Hold(*robot_);
  const std::weak_ptr<RecordingClient> left = std::exchange(robot_, nullptr);
  EXPECT_FALSE(left.expired());
  const auto told = holds.ToldOfAll();
  ASSERT_THAT(told, SizeIs(1));
  static_cast<void>(holds.LoseSince("rcan://a", told[0].held_since));
  EXPECT_TRUE(left.expired());
  EXPECT_THAT(holds.ToldOfAll(), IsEmpty());
}

TEST_F(HoldsTest, ARobotThatIsMadeAnewTakesThePlaceOfTheOneBefore) {
  Hold(*robot_);
  const auto anew = std::make_shared<RecordingClient>("rcan://a");
  Hold(*anew);
  EXPECT_EQ(holds.robots().Since(*robot_), 0U);
  EXPECT_NE(holds.robots().Since(*anew), 0U);
  EXPECT_THAT(holds.ToldOfAll(), SizeIs(1));
}

}  // namespace
}  // namespace uplink::journal
