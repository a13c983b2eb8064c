#include "server/journal/connection_log.h"

#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::journal {
namespace {

using storage::ConnectionItem;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

ConnectionItem Item(std::uint8_t id, std::uint64_t messages = 0, const char* ruri = "a") {
  ConnectionItem item;
  item.robot = std::make_shared<const model::RobotId>(model::RobotId{ruri, "bench"});
  item.id = {id};
  item.messages = messages;
  return item;
}

ConnectionItem Ended(std::uint8_t id, std::uint64_t messages) {
  ConnectionItem item = Item(id, messages);
  item.ended.emplace();
  return item;
}

std::vector<std::string> Lines(const std::vector<ConnectionItem>& items) {
  std::vector<std::string> lines;
  lines.reserve(items.size());
  for (const ConnectionItem& item : items) {
    lines.push_back(item.robot->ruri + std::to_string(item.id[0]) + ":" +
                    std::to_string(item.messages) + (item.ended ? " ended" : ""));
  }
  return lines;
}

TEST(ConnectionLog, HandsOverEachOnceAsItWasNotedLast) {
  ConnectionLog log(9);
  EXPECT_TRUE(log.Note(Item(1)));
  EXPECT_TRUE(log.Note(Item(2)));
  EXPECT_TRUE(log.Note(Item(1, 5)));
  EXPECT_TRUE(log.Note(Item(1, 7, "b"))) << "another robot's";
  EXPECT_TRUE(log.Note(Ended(2, 3)));
  EXPECT_TRUE(log.Note(Item(2, 9))) << "after its end";
  EXPECT_EQ(log.size(), 3U);
  EXPECT_THAT(Lines(log.Take(9)), ElementsAre("a1:5", "a2:3 ended", "b1:7"));
  EXPECT_TRUE(log.empty());
  EXPECT_EQ(log.uncommitted(), 3U);
  log.CountCommitted(3);
  EXPECT_EQ(log.uncommitted(), 0U);
}

TEST(ConnectionLog, HandsOverNoMoreThanItIsAskedFor) {
  ConnectionLog log(9);
  for (std::uint8_t id = 1; id <= 3; ++id) EXPECT_TRUE(log.Note(Item(id)));
  EXPECT_THAT(Lines(log.Take(2)), ElementsAre("a1:0", "a2:0"));
  EXPECT_THAT(Lines(log.Take(2)), ElementsAre("a3:0"));
  EXPECT_THAT(log.Take(2), IsEmpty());
}

TEST(ConnectionLog, WhatIsPutBackGoesFirstUnlessItWasNotedSince) {
  ConnectionLog log(9);
  for (std::uint8_t id = 1; id <= 3; ++id) EXPECT_TRUE(log.Note(Item(id)));
  std::vector<ConnectionItem> taken = log.Take(2);
  EXPECT_TRUE(log.Note(Ended(2, 4)));
  log.PutBack(std::move(taken));
  EXPECT_EQ(log.uncommitted(), 3U) << "one of two is left of the second";
  EXPECT_THAT(Lines(log.Take(9)), ElementsAre("a1:0", "a3:0", "a2:4 ended"));
}

TEST(ConnectionLog, AnEndThatIsPutBackStays) {
  ConnectionLog log(9);
  EXPECT_TRUE(log.Note(Ended(1, 4)));
  std::vector<ConnectionItem> taken = log.Take(1);
  EXPECT_TRUE(log.Note(Item(1, 9)));
  log.PutBack(std::move(taken));
  EXPECT_THAT(Lines(log.Take(9)), ElementsAre("a1:4 ended"));
}

TEST(ConnectionLog, RefusesOneMoreThanItsBoundAndStillTakesNewsOfTheOthers) {
  ConnectionLog log(2);
  EXPECT_TRUE(log.Note(Item(1)));
  EXPECT_TRUE(log.Note(Item(2)));
  EXPECT_FALSE(log.Note(Item(3)));
  EXPECT_TRUE(log.Note(Ended(1, 5)));
  const auto taken = log.Take(1);
  EXPECT_FALSE(log.Note(Item(3))) << "what was taken may come back";
  log.CountCommitted(taken.size());
  EXPECT_TRUE(log.Note(Item(3)));
}

}  // namespace
}  // namespace uplink::journal
