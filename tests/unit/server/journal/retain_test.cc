#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/journal/journal_bench.h"

/// Histories are kept to their age by the journal that has the duty.
namespace uplink::journal {
namespace {

using testing::FailAt;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr std::chrono::days kKept{90};

JournalLimits Retaining() {
  JournalLimits limits;
  limits.retains = true;
  return limits;
}

class JournalRetain : public ::testing::Test, protected JournalBench {
 protected:
  using JournalBench::Run;

  JournalRetain() : JournalBench(Retaining()) {}

  void StoreAFault() {
    RecordingClient client("rcan://a");
    Open(client);
    Append(client, 1);
    Run();
  }
  std::size_t Faults() { return store.FaultHistory({})->rows.size(); }
};

TEST_F(JournalRetain, MakesRoomBeforeAnythingIsWritten) {
  store.FailNextRetains(1, FailAt::kBefore);
  EXPECT_EQ(journal.turns().Advance(), Step::kFailed);
  EXPECT_EQ(store.opens(), 0U);
}

TEST_F(JournalRetain, DeletesWhatIsTooOldEachHour) {
  StoreAFault();
  clock.Advance(kKept);
  Run();
  EXPECT_EQ(Faults(), 1U) << "its day ended less than that ago";
  clock.Advance(std::chrono::days(1));
  Run();
  EXPECT_EQ(Faults(), 0U);
  EXPECT_EQ(probe.history_deleted.value(), 1);
  Run();
  clock.Advance(kRetainInterval - milliseconds(1));
  const auto errors = probe.store_errors.value();
  store.FailNextRetains(1, FailAt::kBefore);
  Run();
  EXPECT_EQ(probe.store_errors.value(), errors) << "not before its time";
  clock.Advance(milliseconds(1));
  Run();
  EXPECT_EQ(probe.store_errors.value(), errors + 1);
}

TEST_F(JournalRetain, AFailureHoldsUpNoCommit) {
  store.FailNextRetains(1, FailAt::kBefore);
  EXPECT_EQ(journal.turns().Advance(), Step::kFailed);
  EXPECT_EQ(probe.store_failing.value(), 1);
  StoreAFault();
  EXPECT_EQ(Faults(), 1U);
  EXPECT_EQ(probe.store_failing.value(), 0);
}

TEST_F(JournalRetain, ATroubleOfItsOwnIsNotTheStores) {
  store.FailNextRetains(1, FailAt::kBefore, absl::FailedPreconditionError("the clocks differ"));
  EXPECT_EQ(journal.turns().Advance(), Step::kWorked);
  EXPECT_EQ(probe.store_failing.value(), 0);
  EXPECT_EQ(probe.retention_failing.value(), 1);
  EXPECT_FALSE(journal.retain_error().ok());
  EXPECT_TRUE(journal.last_error().ok());
  clock.Advance(kRetainLater);
  Run();
  EXPECT_EQ(probe.retention_failing.value(), 0);
  EXPECT_TRUE(journal.retain_error().ok());
}

TEST_F(JournalRetain, WhatWaitsGoesBetweenTwoCalls) {
  RecordingClient client("rcan://a");
  Open(client);
  Run();
  for (model::Seq seq = 1; seq <= storage::kRetainRowsMax + 1; ++seq) Append(client, seq);
  Run();
  const std::size_t before = store.commits();
  clock.Advance(kKept + std::chrono::days(1));
  Append(client, storage::kRetainRowsMax + 2);
  EXPECT_EQ(journal.turns().Advance(), Step::kWorked);
  clock.Advance(kSweepInterval);  // the next duties are due by now
  EXPECT_EQ(store.commits(), before) << "only the histories were looked after";
  EXPECT_EQ(journal.turns().Advance(), Step::kWorked);
  EXPECT_EQ(store.commits(), before + 1);
}

TEST_F(JournalRetain, AfterAFailureItIsTriedAgainSoon) {
  StoreAFault();
  clock.Advance(kKept + std::chrono::days(1));
  store.FailNextRetains(1, FailAt::kBefore);
  Run();
  Run();
  EXPECT_EQ(Faults(), 1U);
  clock.Advance(kRetainAgain);
  Run();
  EXPECT_EQ(Faults(), 0U);
}

TEST(JournalWithoutRetain, LeavesHistoriesAlone) {
  JournalBench bench;
  bench.store.FailNextRetains(1, FailAt::kBefore);
  bench.Run();
  EXPECT_EQ(bench.probe.store_errors.value(), 0);
}

}  // namespace
}  // namespace uplink::journal
