// Whether what twins say comes to our knowledge in time.
#include "server/broker/heard.h"

#include <gtest/gtest.h>

#include "server/broker/limits.h"
#include "tests/support/manual_clock.h"

namespace uplink::broker {
namespace {

class HeardTest : public ::testing::Test {
 protected:
  /// A look each second.
  void Pass(int seconds) {
    for (int i = 0; i < seconds; ++i) {
      clock_.Advance(std::chrono::seconds(1));
      heard_.Look(standing_, durable_);
    }
  }

  testing::ManualClock clock_;
  BrokerProbe probe_;
  const mqtt::ClientProbe durable_{};
  Heard heard_{clock_, probe_};
  Heard::Standing standing_{.subscribed = true, .unacked_max = 10};
};

TEST_F(HeardTest, ABrokerThatIsTooSlowIsFoundOutByItsPings) {
  for (int second = 0; second < kLiveBehindMax.count() + kLivePingWaitMax.count(); ++second) {
    EXPECT_FALSE(heard_.live_is_old()) << second;
    standing_.live_ping_waited = std::chrono::seconds(second);
    heard_.Look(standing_, durable_);
    clock_.Advance(std::chrono::seconds(1));
  }
  EXPECT_TRUE(heard_.live_is_old());
  EXPECT_EQ(heard_.hearing(), fleet::Fleet::HearingState::kBehind);
  standing_.live_ping_waited = milliseconds(1'999);
  heard_.Look(standing_, durable_);
  EXPECT_FALSE(heard_.live_is_old());
  EXPECT_EQ(heard_.hearing(), fleet::Fleet::HearingState::kUpToDate);
}

TEST_F(HeardTest, WhatWeAreTooSlowForTakesNobodyOffline) {
  standing_.live_unread = kLiveBehindBytes - 1;
  Pass(20);
  EXPECT_EQ(heard_.hearing(), fleet::Fleet::HearingState::kUpToDate);
  standing_.live_unread = kLiveBehindBytes;
  Pass(2);
  EXPECT_EQ(heard_.hearing(), fleet::Fleet::HearingState::kUpToDate) << "it may be one burst";
  Pass(1);
  EXPECT_EQ(heard_.hearing(), fleet::Fleet::HearingState::kBehind);
  EXPECT_EQ(probe_.behind.value(), 0);
  EXPECT_FALSE(heard_.live_is_old());
  Pass(8);
  EXPECT_EQ(probe_.behind.value(), 1) << "and it is shown";
  EXPECT_TRUE(heard_.live_is_old());
  standing_.live_unread = 0;
  Pass(1);
  EXPECT_FALSE(heard_.live_is_old());
  EXPECT_EQ(heard_.hearing(), fleet::Fleet::HearingState::kUpToDate);
  standing_.subscribed = false;
  Pass(1);
  standing_.subscribed = true;
  Pass(static_cast<int>(kLiveBehindShown.count()) - 3);
  EXPECT_EQ(probe_.behind.value(), 1) << "though it is made anew";
  Pass(1);
  EXPECT_EQ(probe_.behind.value(), 0);
}

}  // namespace
}  // namespace uplink::broker
