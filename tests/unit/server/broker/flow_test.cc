// What a twin may have stored, and who pays for what is over it.
#include <cstddef>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/fleet/heavy_writers.h"
#include "tests/unit/server/broker/broker_bench.h"

namespace uplink::broker {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using Processed = Intake::Processed;

constexpr std::size_t kBurst = 10;

class FlowTest : public ::testing::Test {
 protected:
  FlowTest() {
    bench_.SetFlow({.records = {.rate = 1, .burst = kBurst}, .bytes = {}});
    EXPECT_TRUE(bench_.TakeLease());
  }
  ~FlowTest() override {
    bench_.Run();
    EXPECT_TRUE(bench_.ledger.Read().messages.Balanced());
    EXPECT_EQ(bench_.ledger.Read().messages.in_flight, 0);
  }
  void AtQos0(std::size_t count, const char* twin = kTwin) {
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_EQ(bench_.Publish(Bench::Of("telemetry", twin), Bench::Event(++number_)),
                Processed::kDone);
    }
  }
  void AtQos1(std::size_t count, const char* twin = kTwin) {
    for (std::size_t i = 0; i < count; ++i) {
      ++id_;
      EXPECT_EQ(bench_.Publish(Bench::Of("telemetry", twin), Bench::Event(++number_),
                               {.id = id_, .handle = id_}),
                Processed::kDone);
    }
  }
  [[nodiscard]] std::uint64_t Limited() const {
    return bench_.ledger.Read()
        .messages.rejects[static_cast<std::size_t>(model::RejectReason::kRateLimited)];
  }
  robot::DurableFlow& FlowOf(const char* twin) { return bench_.fleet.Find(RuriOf(twin))->flow; }

  testing::FakeDatabase database_;
  Bench bench_{database_, 1};
  int number_ = 0;
  std::uint16_t id_ = 0;
};

TEST_F(FlowTest, AtQos0WhatIsOverItIsRejectedAndItsTwinIsNamed) {
  AtQos0(kBurst);
  EXPECT_EQ(Limited(), 0U) << "at the limit";
  AtQos0(5);
  EXPECT_EQ(Limited(), 5U) << "past it";
  EXPECT_THAT(bench_.lines(), Contains(AllOf(HasSubstr("twin_limited robot=" + RuriOf(kTwin)),
                                             HasSubstr("limits.durable_*"))));
  AtQos0(kBurst, kOtherTwin);
  EXPECT_EQ(Limited(), 5U) << "one twin costs only itself";
  bench_.Run();
  EXPECT_EQ(bench_.Count(Became::kStored), 2 * kBurst);
  EXPECT_THAT(bench_.store.Quarantine({})->rows, IsEmpty());
  bench_.clock.Advance(std::chrono::seconds(1));
  AtQos0(2);
  EXPECT_EQ(Limited(), 6U) << "it fills by one per second";
}

TEST_F(FlowTest, AtQos1ABacklogPassesWhileJournalAndDiskHaveRoom) {
  AtQos1(3 * kBurst);
  EXPECT_EQ(Limited(), 0U);
  bench_.Run();
  EXPECT_EQ(bench_.Count(Became::kStored), 3 * kBurst);
  EXPECT_THAT(bench_.Acked(), SizeIs(3 * kBurst));
  EXPECT_THAT(bench_.lines(), IsEmpty());
  // It took all of its flow.
  AtQos0(1);
  EXPECT_EQ(Limited(), 1U);
}

TEST_F(FlowTest, ABacklogEmptiesTheFlowAndLeavesNoDebt) {
  AtQos1(10 * kBurst);
  bench_.clock.Advance(std::chrono::seconds(kBurst));
  AtQos0(kBurst);
  EXPECT_EQ(Limited(), 0U) << "it is full again";
  AtQos0(1);
  EXPECT_EQ(Limited(), 1U);
  EXPECT_GE(FlowOf(kTwin).bytes_total(), 11 * kBurst * Bench::Event(1).size())
      << "the rounds that look at the disk see all of it";
}

TEST_F(FlowTest, AtQos1ItIsLimitedWhileTheJournalIsOverHalfFullAndHoldsNobodyBack) {
  AtQos1(kBurst);
  bench_.over_half = true;
  AtQos1(5);
  EXPECT_EQ(Limited(), 5U);
  EXPECT_THAT(bench_.Acked(), SizeIs(5)) << "so that others are read";
  EXPECT_THAT(bench_.lines(), Contains(HasSubstr("twin_limited robot=" + RuriOf(kTwin))));
  AtQos1(1, kOtherTwin);
  EXPECT_EQ(Limited(), 5U);
  bench_.over_half = false;
  AtQos1(1);
  EXPECT_EQ(Limited(), 5U);
}

TEST_F(FlowTest, AtQos1WhoFillsAScarceDiskIsLimitedAndOthersGoOn) {
  AtQos1(1);
  AtQos1(1, kOtherTwin);
  // As the rounds that look at the disk tell the heavy one.
  FlowOf(kTwin).LimitForDisk(1);
  AtQos1(5);
  EXPECT_EQ(Limited(), 4U) << "a full bucket passes one message, however large";
  EXPECT_THAT(bench_.lines(), Contains(AllOf(HasSubstr("twin_limited robot=" + RuriOf(kTwin)),
                                             HasSubstr("store.free_min"))));
  AtQos1(5, kOtherTwin);
  AtQos0(3, kOtherTwin);
  EXPECT_EQ(Limited(), 4U);
  FlowOf(kTwin).LimitForDisk(std::nullopt);
  AtQos1(5);
  EXPECT_EQ(Limited(), 4U);
}

TEST_F(FlowTest, AtQos1AllWaitWhereNothingMayBeStored) {
  AtQos1(1);
  FlowOf(kTwin).LimitForDisk(0);
  EXPECT_EQ(bench_.Publish(Bench::Of("telemetry"), Bench::Event(9), {.id = 9, .handle = 9}),
            Processed::kHeldBack);
  EXPECT_EQ(Limited(), 0U);
  bench_.intake.DropHeldBack();
}

TEST_F(FlowTest, BytesCountAsTheDisksRoundsSeeThem) {
  AtQos0(1);
  const std::uint64_t of_one = FlowOf(kTwin).bytes_total();
  EXPECT_GE(of_one, Bench::Event(1).size());
  bench_.SetFlow({.records = {}, .bytes = {.rate = 1, .burst = 2 * of_one}});
  AtQos0(3);
  EXPECT_EQ(Limited(), 1U);
  EXPECT_EQ(FlowOf(kTwin).bytes_total(), 3 * of_one) << "what is rejected is not stored";
}

TEST_F(FlowTest, BytesCountAsTheyAreKeptWhereThatIsMore) {
  // A control character has one byte, and what is kept in its place three.
  const std::string payload = R"({"event_type":"e","v":")" + std::string(1'000, '\x7f') + "\"}";
  (void)bench_.Publish(Bench::Of("event"), payload);
  EXPECT_GT(FlowOf(kTwin).bytes_total(), 2 * payload.size());
  EXPECT_LE(FlowOf(kTwin).bytes_total(), 4 * payload.size());
}

TEST_F(FlowTest, WhoFillsTheDiskIsFoundAmongTwins) {
  bench_.SetFlow({.records = {}, .bytes = {}});
  AtQos1(1);
  AtQos1(1, kOtherTwin);
  fleet::HeavyWriters writers;
  writers.Sample(bench_.fleet.All(), milliseconds(0));
  const std::string large = R"({"type":"camera_on","data":")" + std::string(60'000, 'x') + "\"}";
  for (int i = 0; i < 20; ++i) (void)bench_.Publish(Bench::Of("telemetry"), large);
  AtQos1(1, kOtherTwin);
  writers.Sample(bench_.fleet.All(), std::chrono::seconds(10));
  const std::vector<fleet::HeavyWriters::Writer> heavy = writers.Name();
  ASSERT_THAT(heavy, SizeIs(1));
  EXPECT_EQ(heavy.front().ruri, RuriOf(kTwin));
}

TEST_F(FlowTest, RejectedMessagesTakeARecordEach) {
  AtQos0(1);
  for (std::size_t i = 0; i < kBurst + 5; ++i) (void)bench_.Publish(Bench::Of("telemetry"), "{");
  EXPECT_EQ(Limited(), 6U);
  bench_.Run();
  EXPECT_THAT(bench_.store.Quarantine({})->rows, SizeIs(kBurst - 1));
}

TEST_F(FlowTest, LiveStateTakesNothing) {
  AtQos0(kBurst + 1);
  EXPECT_EQ(Limited(), 1U);
  (void)bench_.Publish(Bench::Of("position"), R"({"position":{"x":1,"y":2,"z":3}})");
  EXPECT_EQ(bench_.Count(Became::kApplied), 1U);
  EXPECT_EQ(Limited(), 1U);
}

TEST_F(FlowTest, ARateOfZeroIsNone) {
  bench_.SetFlow({.records = {}, .bytes = {}});
  AtQos0(100);
  EXPECT_EQ(Limited(), 0U);
}

TEST(FlowOfScopes, EachEnvironmentHasABudgetOfItsOwn) {
  testing::FakeDatabase database;
  Bench bench(database, 1, {.journal = {.robot_share = 1}});
  ASSERT_TRUE(bench.TakeLease());
  const auto joined = [&bench](const char* id) {
    (void)bench.Publish(std::string("cyberwave/environment/") + id + "/joined",
                        R"({"type":"joined","data":{"who":"a"}})");
  };
  for (std::size_t i = 0; i < limits::PolicyOf(limits::PolicyId::kRecordsOfScope).at_once; ++i)
    joined(kTwin);
  EXPECT_EQ(bench.Count(Became::kRejected), 0U);
  joined(kTwin);
  EXPECT_EQ(bench.Count(Became::kRejected), 1U);
  EXPECT_THAT(bench.lines(), Contains(HasSubstr(std::string("twin_limited id=") + kTwin)));
  joined(kOtherTwin);
  EXPECT_EQ(bench.Count(Became::kRejected), 1U);
  EXPECT_TRUE(bench.ledger.Read().messages.Balanced());
}

TEST(FlowInAFullJournal, WhoIsPastItDoesNotHoldTheOthersBack) {
  testing::FakeDatabase database;
  Bench bench(database, 1, {.journal = {.records_max = kBurst}});
  bench.SetFlow({.records = {.rate = 1, .burst = kBurst}, .bytes = {}});
  ASSERT_TRUE(bench.TakeLease());
  const auto publish = [&bench](std::uint16_t id, const char* twin) {
    return bench.Publish(Bench::Of("telemetry", twin), Bench::Event(id), {.id = id, .handle = id});
  };
  for (std::uint16_t id = 1; id <= kBurst; ++id) EXPECT_EQ(publish(id, kTwin), Processed::kDone);
  bench.over_half = true;
  EXPECT_EQ(publish(kBurst + 1, kTwin), Processed::kDone);
  EXPECT_EQ(bench.Count(Became::kRejected), 1U);
  EXPECT_EQ(publish(kBurst + 2, kOtherTwin), Processed::kHeldBack) << "there is no room";
  bench.intake.DropHeldBack();
  bench.Run();
  EXPECT_EQ(bench.Count(Became::kStored), kBurst);
  EXPECT_TRUE(bench.ledger.Read().messages.Balanced());
}

}  // namespace
}  // namespace uplink::broker
