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

Outgoing Latest(std::uint64_t tag, std::string of) {
  Outgoing message = Message(Keeping::kDurable, tag);
  message.latest_of = std::move(of);
  return message;
}

TEST(SendQueue, OnlyTheLatestOfTheSameWaits) {
  SendQueue queue;
  EXPECT_TRUE(queue.Offer(Latest(1, "a")));
  EXPECT_TRUE(queue.Offer(Latest(2, "b")));
  EXPECT_TRUE(queue.Offer(Message(Keeping::kDurable, 3)));
  EXPECT_TRUE(queue.Offer(Latest(4, "b")));
  EXPECT_TRUE(queue.Offer(Latest(5, "a")));
  EXPECT_EQ(queue.waiting(), 3U);
  EXPECT_THAT(queue.TakeReplaced(), ElementsAre(2, 1));
  EXPECT_THAT(TakeAll(queue), ElementsAre(3, 4, 5));
  EXPECT_TRUE(queue.empty());
  EXPECT_TRUE(queue.Offer(Latest(6, "a")));
  EXPECT_THAT(queue.TakeReplaced(), IsEmpty()) << "5 was sent";
  EXPECT_THAT(TakeAll(queue), ElementsAre(6));
}

TEST(SendQueue, WhatIsOfferedAnewGivesWayToALaterOneOfTheSame) {
  SendQueue queue;
  queue.OfferLater(Latest(1, "a"), kStart);
  queue.OfferLater(Latest(2, "b"), kStart);
  EXPECT_TRUE(queue.Offer(Latest(3, "a")));
  EXPECT_THAT(queue.TakeReplaced(), ElementsAre(1));
  queue.OfferLater(Latest(4, "a"), kStart);
  EXPECT_THAT(queue.TakeReplaced(), ElementsAre(4)) << "3 is newer, and waits";
  queue.AdmitLater(kStart);
  EXPECT_THAT(TakeAll(queue), ElementsAre(3, 2));
  EXPECT_TRUE(queue.empty());
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

TEST(SendQueue, SaysHowManyWereNotSentAndSinceWhen) {
  SendQueue queue;
  EXPECT_EQ(queue.unsent().messages, 0U);
  EXPECT_FALSE(queue.unsent().since);
  ASSERT_TRUE(queue.Offer(Message(Keeping::kLive, 1, kStart + seconds(3))));
  ASSERT_TRUE(queue.Offer(Message(Keeping::kDurable, 2, kStart + seconds(2))));
  ASSERT_TRUE(queue.Offer(Message(Keeping::kDurable, 3, kStart + seconds(5))));
  EXPECT_EQ(queue.unsent().messages, 3U);
  EXPECT_EQ(queue.unsent().since, kStart + seconds(2));
  queue.OfferLater(Message(Keeping::kDurable, 4, kStart), kStart + seconds(9));
  EXPECT_EQ(queue.unsent().messages, 4U);
  EXPECT_EQ(queue.unsent().since, kStart);
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
