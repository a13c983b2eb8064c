#include <gmock/gmock.h>

#include "storage/bounds.h"
#include "tests/contract/store_contract.h"
#include "tests/support/fake_trust.h"

/// Mission runs that a robot leaves open: their bound, and their age.
namespace uplink::testing {
namespace {

using model::MissionStatus;
using storage::MissionRunRow;
using storage::RunClosed;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class OpenRunsContract : public StoreContract {
 protected:
  storage::CommitRecord Report(const std::string& run,
                               MissionStatus status = MissionStatus::kRunning,
                               std::int64_t after_ms = 0) {
    model::MissionRunStatus report;
    report.mission_id = "m";
    report.run_id = run;
    report.status = status;
    return At(after_ms, Good(++last_, report));
  }
  /// Runs "0", "1", ... up to `count`.
  void Start(std::size_t count) {
    std::vector<storage::CommitRecord> records;
    for (std::size_t i = 0; i < count; ++i) records.push_back(Report(std::to_string(i)));
    EXPECT_THAT(Commit(std::move(records)), Each(storage::OutcomeKind::kStored));
  }
  std::size_t OpenCount(const std::string& ruri = "") {
    storage::MissionsQuery query;
    query.open = true;
    if (!ruri.empty()) query.rows.ruris = {ruri};
    query.rows.page_size = storage::kPageSizeMax;
    std::size_t count = 0;
    do {
      const auto page = store_->reader().MissionRuns(query);
      EXPECT_TRUE(page.ok()) << page.status();
      if (!page.ok()) return count;
      count += page->rows.size();
      query.rows.page_token = page->next_token;
    } while (!query.rows.page_token.empty());
    return count;
  }
  MissionRunRow Run(const std::string& run) {
    storage::MissionsQuery query;
    query.run_id = run;
    const std::vector<MissionRunRow> rows = Runs(query);
    EXPECT_THAT(rows, SizeIs(1)) << run;
    return rows.empty() ? MissionRunRow() : rows.front();
  }
  std::size_t TakeClosed() { return store_->Process(kProcess).TakeRunsClosed(); }
  std::size_t CloseRuns(SystemTime now) {
    const auto closed = store_->Process(kProcess).CloseRuns(now);
    EXPECT_TRUE(closed.ok()) << closed.status();
    return closed.value_or(0);
  }

  static constexpr std::size_t kMax = storage::kOpenRunsPerRobotMax;
  static constexpr std::int64_t kAgeMs = milliseconds(storage::kOpenRunAgeMax).count();
  model::Seq last_ = 0;
};

TEST_P(OpenRunsContract, AtTheBoundAllStayOpen) {
  Open();
  Start(kMax);
  EXPECT_EQ(OpenCount(), kMax);
  EXPECT_EQ(TakeClosed(), 0U);
  Commit({Report("0"), Report("ended", MissionStatus::kComplete)});
  EXPECT_EQ(OpenCount(), kMax) << "a report of an open run, and one of a run that has ended";
  EXPECT_EQ(Run("1").closed, RunClosed::kNot);
  EXPECT_EQ(TakeClosed(), 0U);
}

TEST_P(OpenRunsContract, OneMoreClosesTheOneThatWasReportedLeastRecently) {
  Open();
  Start(kMax);
  Commit({Report("0", MissionStatus::kPaused)});
  Commit({Report("more", MissionStatus::kReady, 7)});
  EXPECT_EQ(OpenCount(), kMax);
  EXPECT_EQ(TakeClosed(), 1U);
  EXPECT_EQ(TakeClosed(), 0U);
  const MissionRunRow closed = Run("1");
  EXPECT_EQ(closed.closed, RunClosed::kForBound);
  EXPECT_EQ(closed.closed_at_ms, UnixMs(Time(7)));
  EXPECT_EQ(closed.status, MissionStatus::kRunning) << "as the robot reported it last";
  EXPECT_EQ(closed.updates, 1U);
  EXPECT_EQ(closed.last_received_at, Time());
  EXPECT_EQ(Run("0").closed, RunClosed::kNot);
  EXPECT_EQ(Run("more").closed_at_ms, 0);
  EXPECT_THAT(Reports({.run_id = "1"}), SizeIs(1)) << "what was reported stays";
}

TEST_P(OpenRunsContract, ManyMoreInOneBatchCloseAsMany) {
  Open();
  Start(kMax);
  Commit({Report("a"), Report("b"), Report("a"), Report("c", MissionStatus::kError)});
  EXPECT_EQ(OpenCount(), kMax);
  EXPECT_EQ(TakeClosed(), 2U);
  EXPECT_EQ(Run("0").closed, RunClosed::kForBound);
  EXPECT_EQ(Run("1").closed, RunClosed::kForBound);
  EXPECT_EQ(Run("2").closed, RunClosed::kNot);
}

TEST_P(OpenRunsContract, TheBoundIsARobotsOwn) {
  Open();
  Start(kMax);
  storage::OpenRequest other = Request();
  other.robot = Robot("b");
  const storage::OpenResult opened = Open(other);
  storage::CommitRecord report = Of(Robot("b"), Report("b's"));
  report.held_since = opened.held_since;
  Commit({report});
  EXPECT_EQ(OpenCount(robot_->ruri), kMax);
  EXPECT_EQ(OpenCount(Robot("b")->ruri), 1U);
}

TEST_P(OpenRunsContract, AClockThatWasSetBackClosesNoRunThatWasReportedJustNow) {
  Open();
  Start(kMax);
  Commit({Report("new", MissionStatus::kRunning, -1'000'000)});
  EXPECT_EQ(Run("new").closed, RunClosed::kNot);
  EXPECT_EQ(Run("0").closed, RunClosed::kForBound);
}

TEST_P(OpenRunsContract, ALaterReportOpensARunThatWasClosed) {
  Open();
  Start(kMax + 1);
  ASSERT_EQ(Run("0").closed, RunClosed::kForBound);
  Commit({Report("0", MissionStatus::kBlocked, 5)});
  const MissionRunRow again = Run("0");
  EXPECT_EQ(again.closed, RunClosed::kNot);
  EXPECT_EQ(again.closed_at_ms, 0);
  EXPECT_EQ(again.status, MissionStatus::kBlocked);
  EXPECT_EQ(again.updates, 2U);
  EXPECT_EQ(again.first_received_at, Time());
  EXPECT_EQ(Run("1").closed, RunClosed::kForBound) << "in its place";
  EXPECT_EQ(OpenCount(), kMax);
}

TEST_P(OpenRunsContract, ALaterEndOfARunThatWasClosedIsItsEnd) {
  Open();
  Start(kMax + 1);
  ASSERT_EQ(Run("0").closed, RunClosed::kForBound);
  Commit({Report("0", MissionStatus::kComplete)});
  EXPECT_EQ(Run("0").closed, RunClosed::kNot);
  EXPECT_EQ(Run("0").status, MissionStatus::kComplete);
  EXPECT_EQ(OpenCount(), kMax);
}

TEST_P(OpenRunsContract, ACommitThatFailedClosedNothing) {
  Open();
  Start(kMax);
  storage::Batch batch;
  batch.records = {Report("more")};
  store_->FailNextWrite(kProcess);
  EXPECT_FALSE(store_->Process(kProcess).Commit(batch).ok());
  EXPECT_EQ(TakeClosed(), 0U);
  EXPECT_EQ(OpenCount(), kMax);
  EXPECT_EQ(Run("0").closed, RunClosed::kNot);
  Commit(batch);
  EXPECT_EQ(TakeClosed(), 1U);
  Commit(batch);
  EXPECT_EQ(TakeClosed(), 0U) << "a duplicate closes nothing";
  EXPECT_EQ(OpenCount(), kMax);
}

TEST_P(OpenRunsContract, OneBesideARecordThatTheDatabaseRefusesClosesToo) {
  store_->RefuseFault("bad");
  Open();
  Start(kMax);
  EXPECT_THAT(Commit({Report("a"), Good(++last_, Fault("bad")), Report("b")}),
              ElementsAre(storage::OutcomeKind::kStored, storage::OutcomeKind::kRefused,
                          storage::OutcomeKind::kStored));
  EXPECT_EQ(OpenCount(), kMax);
  EXPECT_EQ(TakeClosed(), 2U);
}

TEST_P(OpenRunsContract, WhatIsNotReportedForTooLongIsClosed) {
  Open();
  Commit({Report("old"), Report("young"), Report("ended", MissionStatus::kAborted)});
  Commit({Report("young", MissionStatus::kRunning, 1)});
  EXPECT_EQ(CloseRuns(Time(kAgeMs)), 0U) << "at the age, not past it";
  EXPECT_EQ(OpenCount(), 2U);
  EXPECT_EQ(CloseRuns(Time(kAgeMs + 1)), 1U);
  EXPECT_EQ(Run("old").closed, RunClosed::kForAge);
  EXPECT_EQ(Run("old").closed_at_ms, UnixMs(Time(kAgeMs + 1)));
  EXPECT_EQ(Run("old").status, MissionStatus::kRunning);
  EXPECT_EQ(Run("young").closed, RunClosed::kNot);
  EXPECT_EQ(Run("ended").closed, RunClosed::kNot);
  EXPECT_EQ(CloseRuns(Time(kAgeMs + 1)), 0U);
  Commit({Report("old", MissionStatus::kRunning, kAgeMs + 2)});
  EXPECT_EQ(Run("old").closed, RunClosed::kNot);
  EXPECT_EQ(OpenCount(), 2U);
  EXPECT_EQ(TakeClosed(), 0U) << "the bound closed none";
}

TEST_P(OpenRunsContract, AClockThatNobodyVouchesForClosesNothing) {
  FakeTrust trust(false);
  storage::StoreRules rules;
  rules.clock = &trust;
  Fresh(rules);
  Commit({Report("old")});
  EXPECT_EQ(CloseRuns(Time(100 * kAgeMs)), 0U);
  EXPECT_EQ(OpenCount(), 1U);
  trust.Set(true);
  EXPECT_EQ(CloseRuns(Time(100 * kAgeMs)), 1U);
}

TEST_P(OpenRunsContract, ACallClosesABoundedNumberOfRuns) {
  Open();
  OpenAlso({Robot("b")});
  Start(kMax);
  constexpr std::size_t kOthers = 5;
  std::vector<storage::CommitRecord> records;
  records.reserve(kOthers);
  for (std::size_t i = 0; i < kOthers; ++i) {
    records.push_back(Of(Robot("b"), Report("b" + std::to_string(i))));
  }
  Commit(records);
  EXPECT_EQ(CloseRuns(Time(kAgeMs + 1)), storage::kSweepRowsMax);
  EXPECT_EQ(CloseRuns(Time(kAgeMs + 1)), kMax + kOthers - storage::kSweepRowsMax);
  EXPECT_EQ(OpenCount(), 0U);
}

TEST_P(OpenRunsContract, ARunThatWasClosedGoesByItsLastReport) {
  Open();
  Commit({Report("old")});
  ASSERT_EQ(CloseRuns(Time(kAgeMs + 1)), 1U);
  constexpr std::int64_t kDayMs = 86'400'000;
  EXPECT_TRUE(store_->Process(kProcess).Retain(Time(90 * kDayMs)).ok());
  EXPECT_THAT(Runs(), SizeIs(1));
  EXPECT_TRUE(store_->Process(kProcess).Retain(Time(91 * kDayMs)).ok());
  EXPECT_THAT(Runs(), IsEmpty());
  Commit({Report("old", MissionStatus::kRunning, 91 * kDayMs)});
  EXPECT_EQ(Run("old").updates, 1U) << "the earlier run is gone";
}

INSTANTIATE_TEST_SUITE_P(Stores, OpenRunsContract, EveryStore(), NameOfKind);

}  // namespace
}  // namespace uplink::testing
