// What the benchmark of forwarding publishes, and how it counts what arrives.
#include <string>

#include <gtest/gtest.h>

#include "tests/bench/forward/deliveries.h"
#include "tests/bench/forward/update.h"
#include "tests/support/manual_clock.h"

namespace uplink::bench {
namespace {

constexpr std::string_view kOrigin = "rcan://bench.local/robots/7";

/// Counts one update per delivery.
class DeliveriesTest : public ::testing::Test {
 protected:
  [[nodiscard]] std::string UpdateNow() {
    return ForwardOf({.number = ++number_, .at = clock_.Steady()}, kOrigin);
  }

  testing::ManualClock clock_;
  Deliveries deliveries_{clock_};
  std::size_t number_ = 0;
};

TEST(UpdateTest, ItsTimeTravelsInBothForms) {
  const SteadyTime at(std::chrono::nanoseconds(123'456'789));
  EXPECT_EQ(PublishedAt(ReportOf({.number = 1, .at = at})), at);
  EXPECT_EQ(PublishedAt(ForwardOf({.number = 1, .at = at}, kOrigin)), at);
}

TEST(UpdateTest, AMessageWithoutOneHasNoTime) {
  EXPECT_EQ(PublishedAt(""), std::nullopt);
  EXPECT_EQ(PublishedAt("~published at 000000000000000001"), std::nullopt) << "a digit is missing";
  EXPECT_EQ(PublishedAt("~published at 00000000000000000x1"), std::nullopt);
  EXPECT_NE(PublishedAt("~published at 0000000000000000001"), std::nullopt);
}

TEST_F(DeliveriesTest, CountsWhatWasPublishedSinceItBegan) {
  const std::string before = UpdateNow();
  clock_.Advance(milliseconds(1));
  deliveries_.Begin();
  const std::string after = UpdateNow();
  EXPECT_TRUE(deliveries_.Note(before));
  EXPECT_EQ(deliveries_.count(), 0);
  EXPECT_TRUE(deliveries_.Note(after));
  EXPECT_TRUE(deliveries_.Note(after)) << "another receiver's";
  EXPECT_EQ(deliveries_.count(), 2);
  EXPECT_FALSE(deliveries_.Note("something else"));
  EXPECT_EQ(deliveries_.count(), 2);
  deliveries_.Begin();
  EXPECT_EQ(deliveries_.count(), 0);
}

TEST_F(DeliveriesTest, SaysWithinWhichTimeAShareCame) {
  deliveries_.Begin();
  EXPECT_EQ(deliveries_.WaitOf(0.5), 0) << "nothing came";
  const std::string update = UpdateNow();
  for (int i = 0; i < 101; ++i) {
    deliveries_.Note(update);
    clock_.Advance(milliseconds(1));
  }
  EXPECT_EQ(deliveries_.WaitOf(0), 0);
  EXPECT_EQ(deliveries_.WaitOf(0.5), 50);
  EXPECT_EQ(deliveries_.WaitOf(1), 100);
}

}  // namespace
}  // namespace uplink::bench
