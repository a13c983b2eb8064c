#include "server/mqtt/subscriptions.h"

#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/mqtt/limits.h"

namespace uplink::mqtt {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const Filter kA{"a", Qos::kAtLeastOnce};
const Filter kB{"b", Qos::kAtLeastOnce};

std::vector<std::string> Topics(const std::optional<Subscriptions::Ask>& ask) {
  std::vector<std::string> topics;
  if (!ask) return topics;
  for (const Filter& filter : ask->filters) topics.push_back(filter.topic);
  return topics;
}

/// Everything is asked for, and granted.
void GrantAll(Subscriptions& subscriptions) {
  while (const auto ask = subscriptions.Next()) {
    if (!ask->subscribe) {
      subscriptions.Unsubscribed();
      continue;
    }
    std::string codes;
    for (const Filter& filter : ask->filters) codes += static_cast<char>(filter.qos);
    ASSERT_THAT(*subscriptions.Answered(codes), IsEmpty());
  }
}

TEST(MqttSubscriptions, AsksForAllAfterOurStartThoughTheSessionIsThere) {
  Subscriptions subscriptions;
  subscriptions.Want({kA, kB}, {});
  subscriptions.Begin(true);
  EXPECT_FALSE(subscriptions.settled());
  EXPECT_THAT(Topics(subscriptions.Next()), ElementsAre("a", "b"));
  EXPECT_FALSE(subscriptions.Next()) << "one at a time";
  EXPECT_THAT(*subscriptions.Answered("\1\1"), IsEmpty());
  EXPECT_TRUE(subscriptions.settled());
}

TEST(MqttSubscriptions, ASessionThatGoesOnIsNotAskedAgainAndALostOneIs) {
  Subscriptions subscriptions;
  subscriptions.Want({kA, kB}, {});
  subscriptions.Begin(false);
  GrantAll(subscriptions);
  subscriptions.End();
  subscriptions.Begin(true);
  EXPECT_FALSE(subscriptions.Next());
  subscriptions.End();
  subscriptions.Begin(false);
  EXPECT_THAT(Topics(subscriptions.Next()), ElementsAre("a", "b"));
}

TEST(MqttSubscriptions, AsksAgainForWhatWasNotAnswered) {
  Subscriptions subscriptions;
  subscriptions.Want({kA}, {});
  subscriptions.Begin(false);
  EXPECT_TRUE(subscriptions.Next());
  subscriptions.End();
  subscriptions.Begin(true);
  EXPECT_THAT(Topics(subscriptions.Next()), ElementsAre("a"));
}

TEST(MqttSubscriptions, AsksOnlyForWhatChanged) {
  Subscriptions subscriptions;
  subscriptions.Want({kA, kB}, {});
  subscriptions.Begin(false);
  GrantAll(subscriptions);
  subscriptions.Want({kA, {"b", Qos::kAtMostOnce}, {"c", Qos::kAtMostOnce}}, {});
  EXPECT_THAT(Topics(subscriptions.Next()), ElementsAre("b", "c"));
}

TEST(MqttSubscriptions, UnsubscribesFromWhatIsGoneFirst) {
  Subscriptions subscriptions;
  subscriptions.Want({kA, kB}, {"old"});
  subscriptions.Begin(true);
  auto ask = subscriptions.Next();
  EXPECT_FALSE(ask->subscribe);
  EXPECT_THAT(Topics(ask), ElementsAre("old"));
  EXPECT_FALSE(subscriptions.asked_to_subscribe());
  subscriptions.Unsubscribed();
  GrantAll(subscriptions);
  subscriptions.Want({kB}, {});
  ask = subscriptions.Next();
  EXPECT_FALSE(ask->subscribe);
  EXPECT_THAT(Topics(ask), ElementsAre("a"));
  // Whether the broker heard it is not known, so it is said again.
  subscriptions.End();
  subscriptions.Begin(true);
  EXPECT_THAT(Topics(subscriptions.Next()), ElementsAre("a"));
  subscriptions.End();
  subscriptions.Begin(false);
  EXPECT_TRUE(subscriptions.Next()->subscribe) << "a new session holds nothing";
}

TEST(MqttSubscriptions, WhatIsWantedAgainIsNotGone) {
  Subscriptions subscriptions;
  subscriptions.Want({kA}, {});
  subscriptions.Begin(false);
  GrantAll(subscriptions);
  subscriptions.Want({}, {});
  subscriptions.Want({kA}, {});
  const auto ask = subscriptions.Next();
  EXPECT_TRUE(ask->subscribe);
  EXPECT_THAT(Topics(ask), ElementsAre("a"));
}

TEST(MqttSubscriptions, AnAnswerToWhatWasGivenUpMeanwhileCountsForNothing) {
  Subscriptions subscriptions;
  subscriptions.Want({kA}, {});
  subscriptions.Begin(false);
  EXPECT_TRUE(subscriptions.Next());
  subscriptions.Want({kB}, {});
  EXPECT_THAT(*subscriptions.Answered("\x80"), IsEmpty());
  EXPECT_THAT(Topics(subscriptions.Next()), ElementsAre("a")) << "the broker may hold it";
}

TEST(MqttSubscriptions, RefusedAndLowerFiltersAreToldAndRefusedOnesRetried) {
  Subscriptions subscriptions;
  subscriptions.Want({kA, kB}, {});
  subscriptions.Begin(false);
  EXPECT_TRUE(subscriptions.Next());
  const std::string codes("\0\x87", 2);
  const auto lacks = subscriptions.Answered(codes);
  ASSERT_TRUE(lacks);
  ASSERT_THAT(*lacks, SizeIs(2));
  EXPECT_EQ((*lacks)[0].filter, kA);
  EXPECT_EQ((*lacks)[0].code, 0);
  EXPECT_EQ((*lacks)[1].filter, kB);
  EXPECT_EQ((*lacks)[1].code, 0x87);
  EXPECT_EQ(subscriptions.lower(), 1U);
  EXPECT_EQ(subscriptions.refused(), 1U);
  EXPECT_TRUE(subscriptions.settled());
  EXPECT_FALSE(subscriptions.Next());
  subscriptions.RetryRefused();
  EXPECT_THAT(Topics(subscriptions.Next()), ElementsAre("b"));
  EXPECT_THAT(*subscriptions.Answered("\1"), IsEmpty());
  EXPECT_EQ(subscriptions.refused(), 0U);
}

TEST(MqttSubscriptions, AnAnswerThatDoesNotFitIsNone) {
  for (const std::string& codes :
       {std::string(), std::string("\1"), std::string("\1\1\1"), std::string("\1\2")}) {
    Subscriptions subscriptions;
    subscriptions.Want({kA, kB}, {});
    subscriptions.Begin(false);
    EXPECT_TRUE(subscriptions.Next());
    EXPECT_FALSE(subscriptions.Answered(codes)) << codes.size();
  }
}

TEST(MqttSubscriptions, APacketHoldsSoManyFiltersAndNoMore) {
  Subscriptions subscriptions;
  std::vector<Filter> filters;
  for (std::size_t i = 0; i <= kFiltersPerAsk; ++i) filters.push_back({"f" + std::to_string(i)});
  subscriptions.Want(filters, {});
  subscriptions.Begin(false);
  EXPECT_THAT(Topics(subscriptions.Next()), SizeIs(kFiltersPerAsk));
  EXPECT_TRUE(subscriptions.Answered(std::string(kFiltersPerAsk, '\0')));
  EXPECT_THAT(Topics(subscriptions.Next()), SizeIs(1));
}

TEST(MqttSubscriptions, WhatIsGoneHasABound) {
  Subscriptions subscriptions;
  for (std::size_t i = 0; i < Subscriptions::kGoneMax + 10; ++i) {
    subscriptions.Want({{"f" + std::to_string(i)}}, {});
  }
  subscriptions.Begin(true);
  std::set<std::string> gone;
  while (const auto ask = subscriptions.Next()) {
    if (ask->subscribe) break;
    for (const Filter& filter : ask->filters) gone.insert(filter.topic);
    subscriptions.Unsubscribed();
  }
  EXPECT_EQ(gone.size(), Subscriptions::kGoneMax);
}

}  // namespace
}  // namespace uplink::mqtt
