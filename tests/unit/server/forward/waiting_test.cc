// What waits for one receiver: of each item the latest, up to a bound.
#include "server/forward/waiting.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/forward/receiving.h"

namespace uplink::forward {
namespace {

KeyRef Ref(std::string_view id, std::string_view robot = "r") {
  return std::make_shared<const ItemKey>(KeyOf(robot, id));
}

using enum Waiting::Which;

std::string Take(Waiting& waiting, Waiting::Which which = kAll) {
  const EncodedFrame frame = waiting.First(which);
  if (frame == nullptr) return "none";
  waiting.Pop(which);
  return *frame;
}

TEST(WaitingTest, FirstComeFirstTaken) {
  Waiting waiting;
  EXPECT_EQ(waiting.Add(Ref("a"), Text("1"), Change::kChanges), Waiting::Added::kNew);
  EXPECT_EQ(waiting.Add(Ref("b"), Text("2"), Change::kChanges), Waiting::Added::kNew);
  EXPECT_EQ(*waiting.First(kAll), "1");
  EXPECT_EQ(Take(waiting), "1");
  EXPECT_EQ(Take(waiting), "2");
  EXPECT_EQ(waiting.size(), 0U);
}

TEST(WaitingTest, TheLatestOfAnItemTakesThePlaceOfTheFirst) {
  Waiting waiting;
  EXPECT_EQ(waiting.Add(Ref("a"), Text("1"), Change::kChanges), Waiting::Added::kNew);
  EXPECT_EQ(waiting.Add(Ref("b"), Text("2"), Change::kChanges), Waiting::Added::kNew);
  // Another object with the same content: an item that went and came back.
  EXPECT_EQ(waiting.Add(Ref("a"), Text("3"), Change::kChanges), Waiting::Added::kCoalesced);
  EXPECT_EQ(waiting.size(), 2U);
  EXPECT_EQ(Take(waiting), "3");
  EXPECT_EQ(waiting.Add(Ref("a"), Text("4"), Change::kChanges), Waiting::Added::kNew)
      << "it was taken";
  EXPECT_EQ(Take(waiting), "2");
  EXPECT_EQ(Take(waiting), "4");
}

TEST(WaitingTest, WhatComesAndGoesWhileItWaitsIsNotTold) {
  Waiting waiting;
  EXPECT_EQ(waiting.Add(Ref("a"), Text("comes"), Change::kComes), Waiting::Added::kNew);
  EXPECT_EQ(waiting.Add(Ref("a"), Text("changes"), Change::kChanges), Waiting::Added::kCoalesced);
  EXPECT_EQ(waiting.Add(Ref("a"), Text("goes"), Change::kGoes), Waiting::Added::kCancelled);
  EXPECT_EQ(waiting.size(), 0U);
  EXPECT_EQ(waiting.Add(Ref("a"), Text("comes again"), Change::kComes), Waiting::Added::kNew);
  EXPECT_EQ(Take(waiting), "comes again");
}

TEST(WaitingTest, OfWhatWasToldTheEndIsToldToo) {
  Waiting waiting;
  EXPECT_EQ(waiting.Add(Ref("a"), Text("goes"), Change::kGoes), Waiting::Added::kNew);
  EXPECT_EQ(waiting.Add(Ref("a"), Text("comes"), Change::kComes), Waiting::Added::kCoalesced);
  EXPECT_EQ(waiting.Add(Ref("a"), Text("goes again"), Change::kGoes), Waiting::Added::kCoalesced);
  EXPECT_EQ(Take(waiting), "goes again");
}

TEST(WaitingTest, EndsWaitWhileUpsertsAreTaken) {
  Waiting waiting;
  const auto add = [&](std::string_view id, std::string_view text, Change change) {
    return waiting.Add(Ref(id), Text(text), change);
  };
  EXPECT_EQ(add("a", "a goes", Change::kGoes), Waiting::Added::kNew);
  EXPECT_EQ(add("b", "b", Change::kChanges), Waiting::Added::kNew);
  EXPECT_EQ(add("c", "c", Change::kChanges), Waiting::Added::kNew);
  EXPECT_EQ(add("d", "d", Change::kChanges), Waiting::Added::kNew);
  EXPECT_EQ(add("d", "d goes", Change::kGoes), Waiting::Added::kCoalesced);
  EXPECT_EQ(Take(waiting, kUpserts), "b");
  EXPECT_EQ(add("a", "a is back", Change::kComes), Waiting::Added::kCoalesced);
  EXPECT_EQ(Take(waiting, kUpserts), "a is back") << "in the place of its end";
  EXPECT_EQ(Take(waiting, kUpserts), "c");
  EXPECT_EQ(Take(waiting, kUpserts), "none");
  EXPECT_EQ(waiting.size(), 1U);
  EXPECT_EQ(Take(waiting), "d goes");
  EXPECT_EQ(Take(waiting), "none");
}

TEST(WaitingTest, UpsertsAndEndsAreTakenInTheOrderInWhichTheyCame) {
  Waiting waiting;
  for (const char* id : {"1", "3"}) {
    EXPECT_EQ(waiting.Add(Ref(id), Text(id), Change::kChanges), Waiting::Added::kNew);
    const std::string after = std::to_string(std::stoi(id) + 1);
    EXPECT_EQ(waiting.Add(Ref(after), Text(after), Change::kGoes), Waiting::Added::kNew);
  }
  for (const char* id : {"1", "2", "3", "4"}) EXPECT_EQ(Take(waiting), id);
}

TEST(WaitingTest, RobotsTakeTurnsByBytes) {
  Waiting waiting;
  const std::string large(10'000, 'x');
  const auto add = [&](std::string_view robot, std::string_view id, std::string_view text) {
    EXPECT_EQ(waiting.Add(Ref(id, robot), Text(text), Change::kChanges), Waiting::Added::kNew);
  };
  for (const char* id : {"1", "2", "3", "4"}) add("big", id, large);
  EXPECT_EQ(Take(waiting), large);
  // A robot that comes now is behind at most one of those that wait, however many they are.
  for (const char* id : {"1", "2", "3"}) add("small", id, "s");
  for (const char* id : {"1", "2", "3"}) add("other", id, "o");
  std::string order;
  for (int i = 0; i < 6; ++i) order += Take(waiting);
  EXPECT_EQ(order, "sososo");
  EXPECT_EQ(waiting.size(), 3U);
  add("small", "4", large);
  EXPECT_EQ(Take(waiting), large);
  EXPECT_EQ(Take(waiting), large);
  EXPECT_EQ(waiting.size(), 2U) << "one of each: what was not taken is no credit";
}

TEST(WaitingTest, ARobotThatComesBackAtOnceKeepsNobodyWaiting) {
  Waiting waiting;
  const std::string large(10'000, 'x');
  const auto add = [&](std::string_view robot, std::string_view id, std::string_view text) {
    return waiting.Add(Ref(id, robot), Text(text), Change::kChanges);
  };
  EXPECT_EQ(add("big", "1", large), Waiting::Added::kNew);
  EXPECT_EQ(add("small", "1", "small"), Waiting::Added::kNew);
  EXPECT_EQ(Take(waiting), large);
  EXPECT_EQ(add("big", "1", large), Waiting::Added::kNew);
  EXPECT_EQ(Take(waiting), "small");
}

TEST(WaitingTest, SaysFromWhomMostWaits) {
  Waiting waiting;
  EXPECT_EQ(waiting.MostFrom(), "");
  for (const char* id : {"1", "2", "3"}) {
    EXPECT_EQ(waiting.Add(Ref(id, "a"), Text("x"), Change::kGoes), Waiting::Added::kNew);
  }
  for (const char* id : {"1", "2"}) {
    EXPECT_EQ(waiting.Add(Ref(id, "b"), Text("x"), Change::kChanges), Waiting::Added::kNew);
  }
  EXPECT_EQ(waiting.MostFrom(), "a");
  waiting.Clear();
  EXPECT_EQ(waiting.MostFrom(), "");
  EXPECT_EQ(Take(waiting), "none");
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
