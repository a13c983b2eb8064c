#include "server/uncrew/live_samples.h"

#include <gtest/gtest.h>

namespace uplink::uncrew {
namespace {

using model::uncrew::Battery;
using model::uncrew::SampleType;

class LiveSamplesTest : public ::testing::Test {
 protected:
  void Hear(std::int64_t battery) {
    const model::uncrew::Value value = Battery{.key = battery};
    now_ += std::chrono::seconds(1);
    live_.Apply(
        {.value = value, .metadata = {}, .digest = {}, .received = {}, .received_steady = now_});
  }

  LiveSamples live_;
  SteadyTime now_;
};

TEST_F(LiveSamplesTest, OfEachKeyTheNewestIsHeld) {
  Hear(1);
  Hear(2);
  Hear(1);
  ASSERT_EQ(live_.Of(SampleType::kBattery).size(), 2U);
  EXPECT_EQ(live_.Of(SampleType::kBattery)[0].received_steady, now_);
}

TEST_F(LiveSamplesTest, OfTooManyKeysTheLeastRecentGoes) {
  for (std::int64_t key = 0; key < 8; ++key) Hear(key);
  Hear(0);
  Hear(100);
  const auto& held = live_.Of(SampleType::kBattery);
  EXPECT_EQ(held.size(), 8U);
  for (const LiveSample& each : held) EXPECT_NE(each.key, 1);
}

}  // namespace
}  // namespace uplink::uncrew
