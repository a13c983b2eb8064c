// Whether we learn in time what twins say.
#include "server/broker/broker_health.h"

#include <gtest/gtest.h>

#include "server/broker/limits.h"
#include "tests/support/manual_clock.h"

namespace uplink::broker {
namespace {

class BrokerHealthTest : public ::testing::Test {
 protected:
  /// An update each second.
  void Pass(int seconds) {
    for (int i = 0; i < seconds; ++i) {
      clock_.Advance(std::chrono::seconds(1));
      health_.Update(connections_, durable_);
    }
  }

  testing::ManualClock clock_;
  BrokerProbe probe_;
  const mqtt::ClientProbe durable_{};
  BrokerHealth health_{clock_, probe_};
  BrokerHealth::Connections connections_{.subscribed = true, .unacked_max = 10};
};

TEST_F(BrokerHealthTest, ABrokerThatIsTooSlowIsFoundOutByItsPings) {
  for (int second = 0; second < kLiveBehindMax.count() + kLivePingWaitMax.count(); ++second) {
    EXPECT_FALSE(health_.live_is_old()) << second;
    connections_.live_ping_waited = std::chrono::seconds(second);
    health_.Update(connections_, durable_);
    clock_.Advance(std::chrono::seconds(1));
  }
  EXPECT_TRUE(health_.live_is_old());
  EXPECT_EQ(health_.hearing(), fleet::Fleet::HearingState::kBehind);
  connections_.live_ping_waited = milliseconds(1'999);
  health_.Update(connections_, durable_);
  EXPECT_FALSE(health_.live_is_old());
  EXPECT_EQ(health_.hearing(), fleet::Fleet::HearingState::kUpToDate);
}

TEST_F(BrokerHealthTest, WhatWeAreTooSlowForTakesNobodyOffline) {
  connections_.live_unread = kLiveBehindBytes - 1;
  Pass(20);
  EXPECT_EQ(health_.hearing(), fleet::Fleet::HearingState::kUpToDate);
  connections_.live_unread = kLiveBehindBytes;
  Pass(2);
  EXPECT_EQ(health_.hearing(), fleet::Fleet::HearingState::kUpToDate) << "it may be one burst";
  Pass(1);
  EXPECT_EQ(health_.hearing(), fleet::Fleet::HearingState::kBehind);
  EXPECT_EQ(probe_.behind.value(), 0);
  EXPECT_FALSE(health_.live_is_old());
  Pass(8);
  EXPECT_EQ(probe_.behind.value(), 1) << "and it is shown";
  EXPECT_TRUE(health_.live_is_old());
  connections_.live_unread = 0;
  Pass(1);
  EXPECT_FALSE(health_.live_is_old());
  EXPECT_EQ(health_.hearing(), fleet::Fleet::HearingState::kUpToDate);
  connections_.subscribed = false;
  Pass(1);
  connections_.subscribed = true;
  Pass(static_cast<int>(kLiveBehindShown.count()) - 3);
  EXPECT_EQ(probe_.behind.value(), 1) << "though it is made anew";
  Pass(1);
  EXPECT_EQ(probe_.behind.value(), 0);
}

}  // namespace
}  // namespace uplink::broker
