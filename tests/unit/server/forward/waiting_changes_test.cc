// What waits for one receiver: of each item the latest, up to a bound.
#include "server/forward/waiting_changes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/forward/receiving.h"

namespace uplink::forward {
namespace {

KeyRef Ref(std::string_view id, std::string_view robot = "r") {
  return std::make_shared<const ItemKey>(KeyOf(robot, id));
}

using enum WaitingChanges::Which;

std::string Take(WaitingChanges& waiting, WaitingChanges::Which which = kAll) {
  const EncodedFrame frame = waiting.First(which);
  if (frame == nullptr) return "none";
  waiting.Pop(which);
  return *frame;
}

TEST(WaitingChangesTest, FirstComeFirstTaken) {
  WaitingChanges waiting;
  EXPECT_EQ(waiting.Add(Ref("a"), Text("1"), Change::kChanges), WaitingChanges::Added::kNew);
  EXPECT_EQ(waiting.Add(Ref("b"), Text("2"), Change::kChanges), WaitingChanges::Added::kNew);
  EXPECT_EQ(*waiting.First(kAll), "1");
  EXPECT_EQ(Take(waiting), "1");
  EXPECT_EQ(Take(waiting), "2");
  EXPECT_EQ(waiting.size(), 0U);
}

TEST(WaitingChangesTest, TheLatestOfAnItemTakesThePlaceOfTheFirst) {
  WaitingChanges waiting;
  EXPECT_EQ(waiting.Add(Ref("a"), Text("1"), Change::kChanges), WaitingChanges::Added::kNew);
  EXPECT_EQ(waiting.Add(Ref("b"), Text("2"), Change::kChanges), WaitingChanges::Added::kNew);
  // Another object with the same content: an item that went and came back.
  EXPECT_EQ(waiting.Add(Ref("a"), Text("3"), Change::kChanges), WaitingChanges::Added::kCoalesced);
  EXPECT_EQ(waiting.size(), 2U);
  EXPECT_EQ(Take(waiting), "3");
  EXPECT_EQ(waiting.Add(Ref("a"), Text("4"), Change::kChanges), WaitingChanges::Added::kNew)
      << "it was taken";
  EXPECT_EQ(Take(waiting), "2");
  EXPECT_EQ(Take(waiting), "4");
}

TEST(WaitingChangesTest, WhatComesAndGoesWhileItWaitsIsNotTold) {
  WaitingChanges waiting;
  EXPECT_EQ(waiting.Add(Ref("a"), Text("comes"), Change::kComes), WaitingChanges::Added::kNew);
  EXPECT_EQ(waiting.Add(Ref("a"), Text("changes"), Change::kChanges),
            WaitingChanges::Added::kCoalesced);
  EXPECT_EQ(waiting.Add(Ref("a"), Text("goes"), Change::kGoes), WaitingChanges::Added::kCancelled);
  EXPECT_EQ(waiting.size(), 0U);
  EXPECT_EQ(waiting.Add(Ref("a"), Text("comes again"), Change::kComes),
            WaitingChanges::Added::kNew);
  EXPECT_EQ(Take(waiting), "comes again");
}

TEST(WaitingChangesTest, OfWhatWasToldTheEndIsToldToo) {
  WaitingChanges waiting;
  EXPECT_EQ(waiting.Add(Ref("a"), Text("goes"), Change::kGoes), WaitingChanges::Added::kNew);
  EXPECT_EQ(waiting.Add(Ref("a"), Text("comes"), Change::kComes),
            WaitingChanges::Added::kCoalesced);
  EXPECT_EQ(waiting.Add(Ref("a"), Text("goes again"), Change::kGoes),
            WaitingChanges::Added::kCoalesced);
  EXPECT_EQ(Take(waiting), "goes again");
}

TEST(WaitingChangesTest, EndsWaitWhileUpsertsAreTaken) {
  WaitingChanges waiting;
  const auto add = [&](std::string_view id, std::string_view text, Change change) {
    return waiting.Add(Ref(id), Text(text), change);
  };
  EXPECT_EQ(add("a", "a goes", Change::kGoes), WaitingChanges::Added::kNew);
  EXPECT_EQ(add("b", "b", Change::kChanges), WaitingChanges::Added::kNew);
  EXPECT_EQ(add("c", "c", Change::kChanges), WaitingChanges::Added::kNew);
  EXPECT_EQ(add("d", "d", Change::kChanges), WaitingChanges::Added::kNew);
  EXPECT_EQ(add("d", "d goes", Change::kGoes), WaitingChanges::Added::kCoalesced);
  EXPECT_EQ(Take(waiting, kUpserts), "b");
  EXPECT_EQ(add("a", "a is back", Change::kComes), WaitingChanges::Added::kCoalesced);
  EXPECT_EQ(Take(waiting, kUpserts), "a is back") << "in the place of its end";
  EXPECT_EQ(Take(waiting, kUpserts), "c");
  EXPECT_EQ(Take(waiting, kUpserts), "none");
  EXPECT_EQ(waiting.size(), 1U);
  EXPECT_EQ(Take(waiting), "d goes");
  EXPECT_EQ(Take(waiting), "none");
}

TEST(WaitingChangesTest, UpsertsAndEndsAreTakenInTheOrderInWhichTheyCame) {
  WaitingChanges waiting;
  for (const char* id : {"1", "3"}) {
    EXPECT_EQ(waiting.Add(Ref(id), Text(id), Change::kChanges), WaitingChanges::Added::kNew);
    const std::string after = std::to_string(std::stoi(id) + 1);
    EXPECT_EQ(waiting.Add(Ref(after), Text(after), Change::kGoes), WaitingChanges::Added::kNew);
  }
  for (const char* id : {"1", "2", "3", "4"}) EXPECT_EQ(Take(waiting), id);
}

TEST(WaitingChangesTest, RobotsTakeTurnsByBytes) {
  WaitingChanges waiting;
  const std::string large(10'000, 'x');
  const auto add = [&](std::string_view robot, std::string_view id, std::string_view text) {
    EXPECT_EQ(waiting.Add(Ref(id, robot), Text(text), Change::kChanges),
              WaitingChanges::Added::kNew);
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

TEST(WaitingChangesTest, ARobotThatComesBackAtOnceKeepsNobodyWaiting) {
  WaitingChanges waiting;
  const std::string large(10'000, 'x');
  const auto add = [&](std::string_view robot, std::string_view id, std::string_view text) {
    return waiting.Add(Ref(id, robot), Text(text), Change::kChanges);
  };
  EXPECT_EQ(add("big", "1", large), WaitingChanges::Added::kNew);
  EXPECT_EQ(add("small", "1", "small"), WaitingChanges::Added::kNew);
  EXPECT_EQ(Take(waiting), large);
  EXPECT_EQ(add("big", "1", large), WaitingChanges::Added::kNew);
  EXPECT_EQ(Take(waiting), "small");
}

TEST(WaitingChangesTest, SaysFromWhomMostWaits) {
  WaitingChanges waiting;
  EXPECT_EQ(waiting.MostFrom(), "");
  for (const char* id : {"1", "2", "3"}) {
    EXPECT_EQ(waiting.Add(Ref(id, "a"), Text("x"), Change::kGoes), WaitingChanges::Added::kNew);
  }
  for (const char* id : {"1", "2"}) {
    EXPECT_EQ(waiting.Add(Ref(id, "b"), Text("x"), Change::kChanges), WaitingChanges::Added::kNew);
  }
  EXPECT_EQ(waiting.MostFrom(), "a");
  waiting.Clear();
  EXPECT_EQ(waiting.MostFrom(), "");
  EXPECT_EQ(Take(waiting), "none");
}

TEST(WaitingChangesTest, OneMoreThanTheBoundIsNotAdded) {
  WaitingChanges waiting;
  for (std::size_t i = 0; i < kWaitingMax; ++i) {
    ASSERT_EQ(waiting.Add(Ref(std::to_string(i)), Text("x"), Change::kChanges),
              WaitingChanges::Added::kNew);
  }
  EXPECT_EQ(waiting.Add(Ref("more"), Text("x"), Change::kChanges), WaitingChanges::Added::kFull);
  EXPECT_EQ(waiting.Add(Ref("0"), Text("y"), Change::kChanges), WaitingChanges::Added::kCoalesced)
      << "it has a place";
  EXPECT_EQ(waiting.size(), kWaitingMax);
  waiting.Clear();
  EXPECT_EQ(waiting.Add(Ref("0"), Text("x"), Change::kChanges), WaitingChanges::Added::kNew);
}

TEST(WaitingChangesTest, TheBoundIsGiven) {
  WaitingChanges waiting(2);
  EXPECT_EQ(waiting.Add(Ref("a"), Text("1"), Change::kChanges), WaitingChanges::Added::kNew);
  EXPECT_EQ(waiting.Add(Ref("b"), Text("2"), Change::kChanges), WaitingChanges::Added::kNew);
  EXPECT_EQ(waiting.Add(Ref("c"), Text("3"), Change::kChanges), WaitingChanges::Added::kFull);
}

}  // namespace
}  // namespace uplink::forward
