#include "tools/uplink-fleet/compare/conservation.h"

#include <string>

#include <gtest/gtest.h>

namespace uplink::synthetic {
namespace {

constexpr const char* kPage = R"(# HELP uplinkd_mqtt_messages_received_total Messages.
# TYPE uplinkd_mqtt_messages_received_total counter
uplinkd_mqtt_messages_received_total{connection="durable"} 7
uplinkd_mqtt_messages_received_total{connection="live"} 5
uplinkd_mqtt_messages_settled_total{outcome="stored"} 4
uplinkd_mqtt_messages_settled_total{outcome="applied"} 3
uplinkd_mqtt_messages_settled_total{outcome="rejected",connection="live"} 2
uplinkd_mqtt_messages_settled_total{outcome="rejected",connection="durable"} 2
uplinkd_mqtt_messages_in_flight 1
uplinkd_mqtt_messages_in_flight_other 100
uplinkd_forwards_due_total 21
uplinkd_forwards_settled_total{outcome="written"} 6
uplinkd_forwards_settled_total{outcome="coalesced"} 5
uplinkd_forwards_settled_total{outcome="snapshot"} 4
uplinkd_forwards_settled_total{outcome="dropped"} 3
uplinkd_forwards_waiting 2
)";

TEST(Conservation, SumsTheLabelsOfAPage) {
  const auto counts = BrokerMessagesOn(kPage);
  ASSERT_TRUE(counts);
  EXPECT_EQ(counts->received, 12U);
  EXPECT_EQ(counts->in_flight, 1U);
  EXPECT_EQ(counts->Of("rejected"), 4U);
  EXPECT_EQ(counts->Of("ignored"), 0U);
  EXPECT_TRUE(counts->holds());
}

TEST(Conservation, OfForwardsIsReadFromOnePage) {
  const auto counts = ForwardsOn(kPage);
  ASSERT_TRUE(counts);
  EXPECT_EQ(counts->received, 21U);
  EXPECT_EQ(counts->Of("written"), 6U);
  EXPECT_EQ(counts->Of("dropped"), 3U);
  EXPECT_EQ(counts->sum(), 20U);
  EXPECT_FALSE(counts->holds());
}

TEST(Conservation, APageThatLacksAMetricSaysNothing) {
  EXPECT_FALSE(BrokerMessagesOn(""));
  EXPECT_FALSE(BrokerMessagesOn("uplinkd_mqtt_messages_received_total 7\n"));
  const std::string page(kPage);
  EXPECT_FALSE(ForwardsOn(page.substr(0, page.find("uplinkd_forwards_waiting"))));
  EXPECT_FALSE(ForwardsOn(page.substr(0, page.size() - 2) + "x\n"));
}

}  // namespace
}  // namespace uplink::synthetic
