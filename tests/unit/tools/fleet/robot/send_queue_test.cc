#include "tools/uplink-fleet/robot/send_queue.h"

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::synthetic {
namespace {

using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr SteadyTime kStart{seconds(100)};

Outgoing Message(Keeping keeping, std::uint64_t tag, SteadyTime due = kStart) {
  Outgoing message;
  message.keeping = keeping;
  message.tag = tag;
  message.due = due;
  return message;
}

std::vector<std::uint64_t> TakeAll(SendQueue& queue) {
  std::vector<std::uint64_t> tags;
  while (queue.Next() != nullptr) tags.push_back(queue.TakeNext().tag);
  return tags;
}

TEST(SendQueue, GivesLiveAndDurableMessagesInTheOrderOfTheirOffers) {
  SendQueue queue;
  for (std::uint64_t tag = 1; tag <= 4; ++tag) {
    EXPECT_TRUE(queue.Offer(Message(tag % 2 == 0 ? Keeping::kLive : Keeping::kDurable, tag)));
  }
  EXPECT_EQ(queue.waiting(), 4U);
  EXPECT_THAT(TakeAll(queue), ElementsAre(1, 2, 3, 4));
  EXPECT_TRUE(queue.empty());
}

TEST(SendQueue, LetsTheOldestLiveMessageGiveWayPastTheBound) {
  SendQueue queue;
  for (std::size_t i = 0; i < kLiveWaitingMax; ++i) {
    ASSERT_TRUE(queue.Offer(Message(Keeping::kLive, i, kStart + seconds(i))));
  }
  EXPECT_THAT(queue.TakeGaveWay(), IsEmpty());
  EXPECT_TRUE(queue.Offer(Message(Keeping::kLive, kLiveWaitingMax)));
  EXPECT_EQ(queue.waiting(), kLiveWaitingMax);
  EXPECT_THAT(queue.TakeGaveWay(), ElementsAre(kStart));
  EXPECT_THAT(queue.TakeGaveWay(), IsEmpty());
  EXPECT_EQ(queue.Next()->tag, 1U);
}

TEST(SendQueue, RefusesADurableMessagePastTheBound) {
  SendQueue queue;
  for (std::size_t i = 0; i < kDurableWaitingMax; ++i) {
    ASSERT_TRUE(queue.Offer(Message(Keeping::kDurable, i)));
  }
  EXPECT_EQ(queue.durable_room(), 0U);
  EXPECT_FALSE(queue.Offer(Message(Keeping::kDurable, 0)));
  EXPECT_TRUE(queue.Offer(Message(Keeping::kLive, 0)));
}

TEST(SendQueue, HoldsBackWhatMayBeOfferedOnlyLater) {
  SendQueue queue;
  queue.OfferLater(Message(Keeping::kDurable, 7), kStart + seconds(5));
  EXPECT_EQ(queue.Next(), nullptr);
  EXPECT_TRUE(queue.holds_durable());
  EXPECT_FALSE(queue.empty());
  queue.AdmitLater(kStart + seconds(4));
  EXPECT_EQ(queue.waiting(), 0U);
  queue.AdmitLater(kStart + seconds(5));
  EXPECT_THAT(TakeAll(queue), ElementsAre(7));
  EXPECT_FALSE(queue.holds_durable());
}

TEST(SendQueue, DatesWhatWaitsAnew) {
  SendQueue queue;
  ASSERT_TRUE(queue.Offer(Message(Keeping::kLive, 1)));
  ASSERT_TRUE(queue.Offer(Message(Keeping::kDurable, 2)));
  queue.DueAt(kStart + seconds(9));
  EXPECT_EQ(queue.TakeNext().due, kStart + seconds(9));
  EXPECT_EQ(queue.TakeNext().due, kStart + seconds(9));
}

}  // namespace
}  // namespace uplink::synthetic
