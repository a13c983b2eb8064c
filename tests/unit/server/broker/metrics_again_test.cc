// Metrics that come again: those that change no fault leave no record, and are not to be applied
// after those that do.
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/broker/broker_bench.h"

namespace uplink::broker {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;

class MetricsAgainTest : public ::testing::Test {
 protected:
  MetricsAgainTest() { EXPECT_TRUE(bench_.TakeLease()); }

  /// Under the packet id of that number; the numbers of its CPU are the same.
  static void Say(Bench& bench, std::uint16_t id, std::string_view errors, bool dup = false) {
    EXPECT_EQ(bench.Publish(
                  Bench::Of("metrics"),
                  fmt::format(R"({{"metrics":{{"errors":{},"load":{{"cpu":{}}}}}}})", errors, id),
                  {.id = id, .dup = dup, .handle = id}),
              Intake::Processed::kDone);
  }
  [[nodiscard]] std::vector<std::pair<std::string, bool>> Faults() {
    std::vector<std::pair<std::string, bool>> faults;
    const auto page = bench_.store.FaultHistory({});
    for (const storage::FaultRow& row : page->rows) {
      faults.emplace_back(row.fault.fault_id, row.fault.active);
    }
    return faults;
  }
  /// Another process takes the lease, after this one was killed.
  void HandOver(Bench& next) {
    broker::FaultsByRobot faults;
    const auto page = bench_.store.FaultsActive({});
    for (const storage::FaultRow& row : page->rows) {
      faults[row.robot.ruri].push_back(row.fault.fault_id);
    }
    ASSERT_TRUE(next.TakeLease({{.process = {1}, .lease_counter = 0}}));
    next.streams.SetFaults(std::move(faults));
  }

  testing::FakeDatabase database_;
  Bench bench_{database_, 1};
};

TEST_F(MetricsAgainTest, AreDuplicatesByAnotherConnection) {
  Say(bench_, 1, "[]");
  Say(bench_, 2, R"(["hot"])");
  Say(bench_, 3, R"(["hot"])");
  bench_.Run();
  for (std::uint16_t id = 1; id <= 3; ++id) Say(bench_, id, id == 1 ? "[]" : R"(["hot"])", true);
  bench_.Run();
  bench_.Run();
  EXPECT_EQ(bench_.Count(Became::kDuplicate), 3U);
  EXPECT_THAT(Faults(), ElementsAre(Pair("hot", true)));
  EXPECT_THAT(bench_.Acked(), ElementsAre(2, 1, 3, 1, 2, 3));
}

TEST_F(MetricsAgainTest, ThatChangeNoFaultAreAckedAfterACommitThatBeginsLater) {
  Say(bench_, 1, R"(["hot"])");
  bench_.Run();
  EXPECT_THAT(bench_.Acked(), ElementsAre(1));
  Say(bench_, 2, R"(["hot"])");
  EXPECT_EQ(bench_.Count(Became::kApplied), 1U);
  EXPECT_THAT(bench_.Acked(), IsEmpty());
  bench_.store.FailNextCommits(1, testing::FailAt::kBefore);
  bench_.Run();
  EXPECT_THAT(bench_.Acked(), IsEmpty()) << "the store may be gone, and the fault with it";
  bench_.Run();
  EXPECT_THAT(bench_.Acked(), ElementsAre(2));
  EXPECT_THAT(Faults(), ElementsAre(Pair("hot", true)));
}

TEST_F(MetricsAgainTest, OfOneConnectionThatComeAgainByTheNextAreAckedThereAfterACommit) {
  Say(bench_, 1, "[]");
  bench_.commits.BeginConnection();
  Say(bench_, 1, "[]", true);
  EXPECT_EQ(bench_.Count(Became::kDuplicate), 1U);
  EXPECT_THAT(bench_.Acked(), IsEmpty());
  bench_.Run();
  bench_.Run();
  EXPECT_THAT(bench_.Acked(), ElementsAre(1));
}

/// The store lost the fault that they rested on, as a standby that lagged does.
TEST_F(MetricsAgainTest, AreJudgedAgainByTheFaultsOfAStoreThatWentBack) {
  Say(bench_, 1, R"(["hot"])");
  bench_.Run();
  Say(bench_, 2, R"(["hot"])");
  bench_.fleet.Find(RuriOf(kTwin))->OnWentBack(bench_.uplinks).Wake();
  bench_.Look();
  bench_.Reread({});
  Say(bench_, 2, R"(["hot"])", true);
  bench_.Run();
  EXPECT_EQ(bench_.Count(Became::kDuplicate), 0U);
  EXPECT_THAT(Faults(), ElementsAre(Pair("hot", true), Pair("hot", true))) << "it is raised anew";
}

TEST_F(MetricsAgainTest, OfATwinWithoutAStreamRestOnWhatTheStoreHasWhenItIsReadAgain) {
  Say(bench_, 1, R"(["hot"])");
  bench_.Run();
  bench_.clock.Advance(kStreamIdleMax);
  bench_.streams.CloseIdle();
  ASSERT_EQ(bench_.streams.size(), 0U);
  bench_.commits.BeginReread();
  bench_.streams.BeginReread();
  // By the live connection, before the store has said what it has.
  (void)bench_.Publish(Bench::Of("position"), R"({"position":{"x":1,"y":2,"z":3}})");
  bench_.streams.SetFaults({{RuriOf(kTwin), {"cold"}}});
  Say(bench_, 2, R"(["hot"])");
  bench_.Run();
  EXPECT_THAT(Faults(), ::testing::UnorderedElementsAre(Pair("hot", true), Pair("hot", true),
                                                        Pair("cold", false)));
}

TEST_F(MetricsAgainTest, AreDuplicatesForTheNextProcessIfWhatFollowedWasCommitted) {
  Say(bench_, 1, "[]");
  Say(bench_, 2, R"(["hot"])");
  bench_.Run();
  Bench next(database_, 2);
  HandOver(next);
  Say(next, 1, "[]", true);
  Say(next, 2, R"(["hot"])", true);
  next.Run();
  EXPECT_EQ(next.Count(Became::kDuplicate), 2U);
  EXPECT_THAT(Faults(), ElementsAre(Pair("hot", true)));
}

TEST_F(MetricsAgainTest, HoweverManyWereWithoutARecordTheNextProcessKnowsThem) {
  constexpr std::uint16_t kAll = 2'000;
  for (std::uint16_t id = 1; id <= kAll; ++id) Say(bench_, id, "[]");
  Say(bench_, kAll + 1, R"(["hot"])");
  bench_.Run();
  Bench next(database_, 2);
  HandOver(next);
  for (std::uint16_t id = 1; id <= kAll; ++id) Say(next, id, "[]", true);
  Say(next, kAll + 1, R"(["hot"])", true);
  next.Run();
  EXPECT_EQ(next.Count(Became::kDuplicate), kAll + 1U);
  EXPECT_THAT(Faults(), ElementsAre(Pair("hot", true)));
}

TEST_F(MetricsAgainTest, EndWhatTheNextProcessKnowsOfTheirIds) {
  const std::string beat = R"({"type":"beat"})";
  EXPECT_EQ(bench_.Publish(Bench::Of("telemetry", kOtherTwin), beat, {.id = 7, .handle = 7}),
            Intake::Processed::kDone);
  bench_.Run();
  // They never leave a record, and have the ids by now.
  Say(bench_, 7, "[]");
  bench_.Remember(bench_.commits.TakeExpired());
  bench_.Write();
  Bench next(database_, 2);
  HandOver(next);
  EXPECT_EQ(
      next.Publish(Bench::Of("telemetry", kOtherTwin), beat, {.id = 7, .dup = true, .handle = 8}),
      Intake::Processed::kDone);
  next.Run();
  EXPECT_EQ(next.Count(Became::kStored), 1U) << "it is another one";
  EXPECT_EQ(next.store.Events({})->rows.size(), 2U);
}

TEST_F(MetricsAgainTest, WhatWasFencedIsRightThoughTheTwinSpokeMeanwhile) {
  Say(bench_, 1, R"(["first"])");
  bench_.Run();
  bench_.fleet.Find(RuriOf(kTwin))->OnFenced(bench_.uplinks).Wake();
  bench_.Look();
  ASSERT_TRUE(bench_.commits.TakeFenced());
  // By the live connection, before the store has said what it has.
  (void)bench_.Publish(Bench::Of("position"), R"({"position":{"x":1,"y":2,"z":3}})");
  bench_.streams.SetFaults({{RuriOf(kTwin), {"first"}}});
  Say(bench_, 2, "[]");
  bench_.Run();
  EXPECT_THAT(Faults(), ::testing::UnorderedElementsAre(Pair("first", true), Pair("first", false)));
}

TEST_F(MetricsAgainTest, AreNewForTheNextProcessIfNothingThatFollowedWasCommitted) {
  Say(bench_, 1, R"(["old"])");
  bench_.Run();
  Say(bench_, 2, R"(["old"])");
  Say(bench_, 3, R"(["hot"])");
  // It is killed before the commit.
  Bench next(database_, 2);
  HandOver(next);
  Say(next, 2, R"(["old"])", true);
  Say(next, 3, R"(["hot"])", true);
  next.Run();
  EXPECT_EQ(next.Count(Became::kDuplicate), 0U);
  EXPECT_THAT(Faults(), ::testing::UnorderedElementsAre(Pair("old", true), Pair("hot", true),
                                                        Pair("old", false)));
}

TEST_F(MetricsAgainTest, AreKnownToTheNextProcessThoughWhatFollowedCameAtQos0) {
  Say(bench_, 1, "[]");
  (void)bench_.Publish(Bench::Of("metrics"), R"({"metrics":{"errors":["hot"]}})");
  bench_.Run();
  Bench next(database_, 2);
  HandOver(next);
  Say(next, 1, "[]", true);
  next.Run();
  EXPECT_THAT(Faults(), ElementsAre(Pair("hot", true)));
}

TEST_F(MetricsAgainTest, WhatWasFencedIsRaisedWhenItComesAgain) {
  Say(bench_, 1, R"(["first"])");
  bench_.Run();
  Say(bench_, 2, R"(["first","hot"])");
  bench_.fleet.Find(RuriOf(kTwin))->OnFenced(bench_.uplinks).Wake();
  bench_.Look();
  ASSERT_TRUE(bench_.commits.TakeFenced());
  bench_.streams.SetFaults({{RuriOf(kTwin), {"first"}}});
  Say(bench_, 2, R"(["first","hot"])", true);
  bench_.Run();
  EXPECT_THAT(Faults(), ::testing::UnorderedElementsAre(Pair("first", true), Pair("hot", true)));
}

/// What was settled before it without a record is forgotten with it: known here alone, it would not
/// be remembered with the record, and the next process would apply it after that.
TEST_F(MetricsAgainTest, WhatWasFencedBringsTheSameToTheStoreWhenItComesAgain) {
  Say(bench_, 1, "[]");
  Say(bench_, 2, R"(["hot"])");
  Say(bench_, 3, R"(["hot"])");
  bench_.fleet.Find(RuriOf(kTwin))->OnFenced(bench_.uplinks).Wake();
  bench_.Look();
  ASSERT_TRUE(bench_.commits.TakeFenced());
  bench_.Reread({});
  Say(bench_, 1, "[]", true);
  Say(bench_, 2, R"(["hot"])", true);
  Say(bench_, 3, R"(["hot"])", true);
  bench_.Run();
  EXPECT_THAT(Faults(), ElementsAre(Pair("hot", true)));
  // No PUBACK of these arrived, and this process is killed.
  Bench next(database_, 2);
  HandOver(next);
  Say(next, 1, "[]", true);
  Say(next, 2, R"(["hot"])", true);
  next.Run();
  EXPECT_EQ(next.Count(Became::kDuplicate), 2U);
  EXPECT_THAT(Faults(), ElementsAre(Pair("hot", true)));
}

TEST_F(MetricsAgainTest, NewsOfFaultsAloneCountForTheirRate) {
  constexpr int kMessages = 1'000;
  for (int i = 0; i < kMessages; ++i) {
    (void)bench_.Publish(Bench::Of("metrics"), R"({"metrics":{"errors":["a","b","c","d"]}})");
  }
  bench_.Run();
  EXPECT_EQ(bench_.Count(Became::kRejected), 0U);
  EXPECT_EQ(bench_.Count(Became::kApplied), kMessages - 1U);
}

}  // namespace
}  // namespace uplink::broker
