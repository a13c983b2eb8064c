#include "server/journal/outcomes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/journal/step_bench.h"

namespace uplink::journal {
namespace {

using storage::OutcomeKind;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class OutcomesTest : public ::testing::Test {
 protected:
  void Add(RecordingClient& client, model::Seq seq, OutcomeKind kind = OutcomeKind::kStored) {
    batch_.Add(StepBench::EntryOf(client, seq));
    outcomes_.push_back({.kind = kind});
  }
  void AddGap(RecordingClient& client, model::Seq first) {
    batch_.Add(StepBench::GapEntryOf(client, first));
  }
  /// The streams to wake.
  std::vector<std::uint64_t> Tell() {
    std::vector<std::uint64_t> streams;
    for (const loop::StreamRef stream : TellOutcomes(batch_, outcomes_, bench_.holds, ledger_)) {
      streams.push_back(stream.stream);
    }
    return streams;
  }

  CountingInbox wakes_;
  metrics::Ledger ledger_;
  RecordingClient a_{"rcan://a", {.inbox = &wakes_, .stream = 1}};
  RecordingClient b_{"rcan://b", {.inbox = &wakes_, .stream = 2}};
  StepBench bench_;
  GatheredBatch batch_{model::SessionId()};
  std::vector<storage::Outcome> outcomes_;
};

TEST_F(OutcomesTest, AreToldOncePerRobotInOrder) {
  Add(b_, 7);
  Add(a_, 1);
  Add(b_, 8, OutcomeKind::kRefused);
  Add(a_, 2, OutcomeKind::kDuplicate);
  EXPECT_THAT(Tell(), ElementsAre(2, 1)) << "in order of their first records";
  EXPECT_THAT(a_.Told(), ElementsAre("settled 1 2 again"));
  EXPECT_THAT(b_.Told(), ElementsAre("settled 7 8 refused"));
  EXPECT_EQ(wakes_.wakes(1) + wakes_.wakes(2), 0) << "the caller wakes";
}

TEST_F(OutcomesTest, ARejectedPayloadIsToldWithItsReason) {
  Entry entry = StepBench::EntryOf(a_, 1);
  std::get<storage::CommitRecord>(entry.item).content =
      storage::QuarantineItem{{model::RejectReason::kMalformed, "", "cut"}};
  batch_.Add(std::move(entry));
  outcomes_.emplace_back();
  EXPECT_THAT(Tell(), SizeIs(1));
  EXPECT_THAT(a_.Told(), ElementsAre("settled 1 rejected"));
}

TEST_F(OutcomesTest, WhatAnEarlierTryStoredIsStored) {
  Add(a_, 1, OutcomeKind::kDuplicate);
  batch_.MarkTried();
  Add(a_, 2, OutcomeKind::kDuplicate);
  EXPECT_THAT(Tell(), SizeIs(1));
  EXPECT_THAT(a_.Told(), ElementsAre("settled 1 2 again"));
}

TEST_F(OutcomesTest, AFencedRobotIsToldOnceAfterTheOthersAndIsNotHeldAnyMore) {
  bench_.Hold(a_);
  bench_.Hold(b_);
  Add(a_, 1, OutcomeKind::kFenced);
  Add(b_, 1);
  Add(a_, 2, OutcomeKind::kFenced);
  EXPECT_THAT(Tell(), ElementsAre(2, 1));
  EXPECT_THAT(a_.Told(), ElementsAre("fenced"));
  EXPECT_FALSE(bench_.holds.robots().MayCommit({.client = &a_, .generation = a_.generation()}));
  EXPECT_TRUE(bench_.holds.robots().MayCommit({.client = &b_, .generation = b_.generation()}));
}

TEST_F(OutcomesTest, AFencedSampleEndsNoHoldOfItsRobot) {
  bench_.Hold(a_);
  RecordingClient drone("rcan://a", {.inbox = &wakes_, .stream = 3});
  for (const model::Seq seq : {1U, 2U}) {
    Entry entry = StepBench::EntryOf(drone, seq);
    entry.origin.is_sample = true;
    batch_.Add(std::move(entry));
    outcomes_.push_back({.kind = OutcomeKind::kFenced});
  }
  Add(a_, 1);
  EXPECT_THAT(Tell(), ElementsAre(1, 3));
  EXPECT_THAT(drone.Told(), ElementsAre("fenced"));
  EXPECT_THAT(a_.Told(), ElementsAre("settled 1"));
  EXPECT_NE(bench_.holds.robots().Since(a_), 0U);
}

TEST_F(OutcomesTest, WhatBecameVoidIsNotTold) {
  Add(a_, 1);
  Add(b_, 1);
  static_cast<void>(a_.OnFenced(ledger_));
  static_cast<void>(a_.Told());
  EXPECT_THAT(Tell(), ElementsAre(2));
  EXPECT_THAT(a_.Told(), IsEmpty());
}

TEST_F(OutcomesTest, GapsAreToldOneByOneAfterAllRecords) {
  AddGap(a_, 1);
  Add(a_, 5);
  AddGap(b_, 2);
  AddGap(a_, 3);
  EXPECT_THAT(Tell(), ElementsAre(1, 1, 2, 1));
  EXPECT_THAT(a_.Told(), ElementsAre("settled 5", "gaps 1", "gaps 1"));
  EXPECT_THAT(b_.Told(), ElementsAre("gaps 1"));
}

}  // namespace
}  // namespace uplink::journal
