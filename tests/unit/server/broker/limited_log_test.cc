// What the log says of twins that send too much.
#include "server/broker/limited_log.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/broker/limits.h"
#include "tests/unit/server/broker/broker_bench.h"

namespace uplink::broker {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class LimitedLogTest : public ::testing::Test {
 protected:
  LimitedLogTest() { EXPECT_TRUE(bench_.TakeLease()); }

  /// As much as the twin's rate has, and so much more.
  void Flood(const char* twin, std::size_t beyond) {
    const auto burst = static_cast<std::size_t>(cyberwave::kMessagesOfTwin.burst);
    for (std::size_t i = 0; i < burst + beyond; ++i) {
      (void)bench_.Publish(Bench::Of("position", twin), R"({"position":{"x":1,"y":2,"z":3}})");
    }
  }

  testing::FakeDatabase database_;
  Bench bench_{database_, 1};
};

TEST_F(LimitedLogTest, NamesEachOfSeveralTwinsOnce) {
  Flood(kTwin, 100);
  Flood(kOtherTwin, 100);
  EXPECT_THAT(bench_.lines(), SizeIs(2));
  for (const char* twin : {kTwin, kOtherTwin}) {
    EXPECT_THAT(bench_.lines(), Contains(HasSubstr("twin_limited robot=" + RuriOf(twin))));
  }
}

TEST_F(LimitedLogTest, NamesATwinThatGoesOnAgain) {
  Flood(kTwin, 100);
  bench_.clock.Advance(log::RateLimited::kSpan - milliseconds(1));
  Flood(kTwin, 100);
  EXPECT_THAT(bench_.lines(), SizeIs(1));
  bench_.clock.Advance(milliseconds(1));
  Flood(kTwin, 100);
  EXPECT_THAT(bench_.lines(), SizeIs(2));
}

TEST(BudgetKeyOf, IsOneOfAnIdUnderAPrefixAndOfAKind) {
  using enum cyberwave::TopicKind;
  const auto id = *model::cyberwave::Uuid::FromText("00000000-0000-4000-8000-000000000001");
  const auto other = *model::cyberwave::Uuid::FromText("00000000-0000-4000-8000-000000000002");
  const cyberwave::Topic command{.kind = kCommand, .identified = true, .id = id};
  const cyberwave::Topic ping{.kind = kPing, .identified = true, .name = "a"};
  struct Row {
    cyberwave::Topic left;
    cyberwave::Topic right;
    bool same;
  };
  for (const Row& row : std::vector<Row>{
           {command, command, true},
           {command, {.kind = kPosition, .identified = true, .id = id}, true},
           {command, {.kind = kCommand, .identified = true, .id = other}, false},
           {command, {.kind = kCommand, .prefix = "lab/", .identified = true, .id = id}, false},
           {command, {.kind = kEnvironment, .identified = true, .id = id}, false},
           {ping, {.kind = kPing, .identified = true, .name = "a"}, true},
           {ping, {.kind = kPing, .identified = true, .name = "b"}, false},
       }) {
    EXPECT_EQ(BudgetKeyOf(row.left) == BudgetKeyOf(row.right), row.same)
        << static_cast<int>(row.right.kind) << row.right.prefix << row.right.name;
  }
  EXPECT_EQ(BudgetKeyOf({.kind = kCommand}), std::nullopt);
}

}  // namespace
}  // namespace uplink::broker
