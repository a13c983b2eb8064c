#include "server/broker/digest.h"

#include <string_view>

#include <gtest/gtest.h>

namespace uplink::broker {
namespace {

storage::DeliveryDigest Of(std::string_view topic, std::string_view payload) {
  mqtt::Publish publish;
  publish.topic = topic;
  publish.payload = payload;
  publish.payload_bytes = payload.size();
  return DigestOf(publish);
}

TEST(DigestOf, IsTheSameForTheSameTopicAndPayload) {
  EXPECT_EQ(Of("a/b", "text"), Of("a/b", "text"));
  EXPECT_NE(Of("a/b", "text"), Of("a/b", "texts"));
  EXPECT_NE(Of("a/b", "text"), Of("a/c", "text"));
}

TEST(DigestOf, NoTopicAndPayloadReadLikeAnotherPair) {
  EXPECT_NE(Of("ab", "c"), Of("a", "bc"));
  EXPECT_NE(Of("abc", ""), Of("", "abc"));
}

TEST(DigestOf, OfWhatWasReadPastItsSizeCounts) {
  mqtt::Publish large;
  large.topic = "a/b";
  large.payload_bytes = 70'000;
  mqtt::Publish larger = large;
  larger.payload_bytes = 70'001;
  EXPECT_EQ(DigestOf(large), DigestOf(large));
  EXPECT_NE(DigestOf(large), DigestOf(larger));
}

}  // namespace
}  // namespace uplink::broker
