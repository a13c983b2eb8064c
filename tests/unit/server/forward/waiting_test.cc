// What waits for one receiver: of each item the latest, up to a bound.
#include "server/forward/waiting.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/forward/receiving.h"

namespace uplink::forward {
namespace {

KeyRef Ref(std::string_view id) { return std::make_shared<const ItemKey>(KeyOf("r", id)); }

TEST(WaitingTest, FirstComeFirstTaken) {
  Waiting waiting;
  EXPECT_EQ(waiting.Add(Ref("a"), Text("1"), Change::kChanges), Waiting::Added::kNew);
  EXPECT_EQ(waiting.Add(Ref("b"), Text("2"), Change::kChanges), Waiting::Added::kNew);
  EXPECT_EQ(*waiting.first(), "1");
  EXPECT_EQ(*waiting.Take(), "1");
  EXPECT_EQ(*waiting.Take(), "2");
  EXPECT_EQ(waiting.size(), 0U);
}

TEST(WaitingTest, TheLatestOfAnItemTakesThePlaceOfTheFirst) {
  Waiting waiting;
  EXPECT_EQ(waiting.Add(Ref("a"), Text("1"), Change::kChanges), Waiting::Added::kNew);
  EXPECT_EQ(waiting.Add(Ref("b"), Text("2"), Change::kChanges), Waiting::Added::kNew);
  // Another object with the same content: an item that went and came back.
  EXPECT_EQ(waiting.Add(Ref("a"), Text("3"), Change::kChanges), Waiting::Added::kCoalesced);
  EXPECT_EQ(waiting.size(), 2U);
  EXPECT_EQ(*waiting.Take(), "3");
  EXPECT_EQ(waiting.Add(Ref("a"), Text("4"), Change::kChanges), Waiting::Added::kNew)
      << "it was taken";
  EXPECT_EQ(*waiting.Take(), "2");
  EXPECT_EQ(*waiting.Take(), "4");
}

TEST(WaitingTest, WhatComesAndGoesWhileItWaitsIsNotTold) {
  Waiting waiting;
  EXPECT_EQ(waiting.Add(Ref("a"), Text("comes"), Change::kComes), Waiting::Added::kNew);
  EXPECT_EQ(waiting.Add(Ref("a"), Text("changes"), Change::kChanges), Waiting::Added::kCoalesced);
  EXPECT_EQ(waiting.Add(Ref("a"), Text("goes"), Change::kGoes), Waiting::Added::kCancelled);
  EXPECT_EQ(waiting.size(), 0U);
  EXPECT_EQ(waiting.Add(Ref("a"), Text("comes again"), Change::kComes), Waiting::Added::kNew);
  EXPECT_EQ(*waiting.Take(), "comes again");
}

TEST(WaitingTest, OfWhatWasToldTheEndIsToldToo) {
  Waiting waiting;
  EXPECT_EQ(waiting.Add(Ref("a"), Text("goes"), Change::kGoes), Waiting::Added::kNew);
  EXPECT_EQ(waiting.Add(Ref("a"), Text("comes"), Change::kComes), Waiting::Added::kCoalesced);
  EXPECT_EQ(waiting.Add(Ref("a"), Text("goes again"), Change::kGoes), Waiting::Added::kCoalesced);
  EXPECT_EQ(*waiting.Take(), "goes again");
}

TEST(WaitingTest, OneMoreThanTheBoundIsNotAdded) {
  Waiting waiting;
  for (std::size_t i = 0; i < kWaitingMax; ++i) {
    ASSERT_EQ(waiting.Add(Ref(std::to_string(i)), Text("x"), Change::kChanges),
              Waiting::Added::kNew);
  }
  EXPECT_EQ(waiting.Add(Ref("more"), Text("x"), Change::kChanges), Waiting::Added::kFull);
  EXPECT_EQ(waiting.Add(Ref("0"), Text("y"), Change::kChanges), Waiting::Added::kCoalesced)
      << "it has a place";
  EXPECT_EQ(waiting.size(), kWaitingMax);
  waiting.Clear();
  EXPECT_EQ(waiting.Add(Ref("0"), Text("x"), Change::kChanges), Waiting::Added::kNew);
}

TEST(WaitingTest, TheBoundIsGiven) {
  Waiting waiting(2);
  EXPECT_EQ(waiting.Add(Ref("a"), Text("1"), Change::kChanges), Waiting::Added::kNew);
  EXPECT_EQ(waiting.Add(Ref("b"), Text("2"), Change::kChanges), Waiting::Added::kNew);
  EXPECT_EQ(waiting.Add(Ref("c"), Text("3"), Change::kChanges), Waiting::Added::kFull);
}

}  // namespace
}  // namespace uplink::forward
