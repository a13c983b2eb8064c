// What a robot shares with others ends in every way in which it can.
#include "tools/uplink-fleet/robot/behaviour/sharing.h"

#include <map>
#include <set>

#include <gtest/gtest.h>

#include "tools/uplink-fleet/robot/arrival.h"

namespace uplink::synthetic {
namespace {

constexpr std::int64_t kNowMs = 1'763'683'200'000;

Outbox Life(std::uint64_t seed, const std::string& mark) {
  Sharing sharing(Seeded(seed), mark, "run");
  Facts facts;
  facts.pose = {.lat_deg = 47, .lon_deg = 8, .altitude_m = 400, .heading_deg = 0};
  Outbox out;
  for (int i = 1; i <= 12'000; ++i) sharing.Advance({kNowMs + 100 * i, 0.1}, facts, out);
  return out;
}

bool IsShared(model::ScopeType scope) {
  return scope == model::ScopeType::kFleet || scope == model::ScopeType::kWorld;
}

/// How often something became of an item.
struct Ways {
  int revised = 0;
  int narrowed = 0;
  int widened = 0;
  int deleted = 0;
  int told_again = 0;
};

template <typename Op>
Ways WaysOf(const Outbox& out, const std::string& id) {
  Ways ways;
  std::map<std::string, model::ScopeType> present;
  for (const model::Body& body : out) {
    const auto* op = std::get_if<Op>(&body);
    if (op == nullptr || op->id() != id) continue;
    const auto before = present.find(id);
    if (op->upsert() == nullptr) {
      EXPECT_NE(before, present.end());
      present.erase(id);
      ++ways.deleted;
      continue;
    }
    if (before == present.end()) {
      if (ways.deleted > 0) ++ways.told_again;
    } else if (IsShared(before->second)) {
      ++(IsShared(op->upsert()->scope) ? ways.revised : ways.narrowed);
    } else if (IsShared(op->upsert()->scope)) {
      ++ways.widened;
    }
    present[id] = op->upsert()->scope;
  }
  return ways;
}

void ExpectAll(const Ways& ways) {
  EXPECT_GT(ways.revised, 5);
  EXPECT_GT(ways.narrowed, 5);
  EXPECT_GT(ways.widened, 5);
  EXPECT_GT(ways.deleted, 5);
  EXPECT_GT(ways.told_again, 5);
}

TEST(Sharing, TheCommonItemsGoThroughAllThatCanBecomeOfThem) {
  ExpectAll(WaysOf<model::ShapeOp>(Life(1, "run-1"), "run-common"));
  ExpectAll(WaysOf<model::ObjectOp>(Life(2, "run-2"), "run-common"));
}

TEST(Sharing, ShortLivedOnesExpireAndSomeAreToldAgainWithTheSameContents) {
  std::map<std::string, model::ReportedShape> flashes;
  int again = 0;
  for (const model::Body& body : Life(3, "run-3")) {
    const auto* op = std::get_if<model::ShapeOp>(&body);
    if (op == nullptr || !op->id().starts_with("run-3-flash-")) continue;
    ASSERT_NE(op->upsert(), nullptr);
    model::ReportedShape shape = *op->upsert();
    EXPECT_GT(shape.expire_time_ms, kNowMs);
    const auto before = flashes.find(op->id());
    if (before != flashes.end()) {
      ++again;
      EXPECT_GT(shape.expire_time_ms, before->second.expire_time_ms);
      shape.expire_time_ms = before->second.expire_time_ms;
      EXPECT_EQ(shape, before->second);
    }
    flashes[op->id()] = shape;
  }
  EXPECT_GT(flashes.size(), 50U);
  EXPECT_GT(again, 5);
}

TEST(ArrivalTest, ComesAtItsTimeOrWhenTheRunIsOver) {
  const SteadyTime start{};
  const SteadyTime at = start + milliseconds(250);
  Arrival arrival(at);
  EXPECT_EQ(arrival.Awaited(start, Stage::kRun), start + kArrivalLook);
  EXPECT_EQ(arrival.Awaited(start + milliseconds(200), Stage::kRun), at);
  EXPECT_FALSE(arrival.Awaited(at, Stage::kRun));
  Arrival sooner(at);
  EXPECT_FALSE(sooner.Awaited(start, Stage::kSettle));
  EXPECT_FALSE(sooner.Awaited(start, Stage::kRun)) << "who is there stays";
}

}  // namespace
}  // namespace uplink::synthetic
