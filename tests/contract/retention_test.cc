#include <gmock/gmock.h>

#include "storage/bounds.h"
#include "tests/contract/store_contract.h"
#include "tests/support/fake_trust.h"

/// What goes for its age: whole days, UTC, of arrival.
namespace uplink::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr std::int64_t kDayMs = 86'400'000;

class RetentionContract : public StoreContract {
 protected:
  static model::EventTelemetry Event() {
    model::EventTelemetry event;
    event.kind = model::EstopEngagedEvent{};
    return event;
  }
  static model::MissionRunStatus Report(const std::string& run, model::MissionStatus status) {
    model::MissionRunStatus report;
    report.mission_id = "m";
    report.run_id = run;
    report.status = status;
    return report;
  }
  std::size_t Retain(std::int64_t now_ms) {
    const auto erased = store_->Process(kProcess).Retain(Time(now_ms));
    EXPECT_TRUE(erased.ok()) << erased.status();
    return erased.ok() ? erased->rows : 0;
  }
  /// One of each kind that has a history, `after_ms` after Time(), which begins a day.
  void CommitOneOfEach(std::int64_t after_ms, const std::string& run) {
    std::vector<storage::CommitRecord> records;
    records.push_back(At(after_ms, Good(++last_, Fault("f"))));
    records.push_back(At(after_ms, Good(++last_, Event())));
    records.push_back(At(after_ms, Good(++last_, Note())));
    records.push_back(At(after_ms, Good(++last_, Report(run, model::MissionStatus::kComplete))));
    records.push_back(At(after_ms, Bad(++last_)));
    records.push_back(At(after_ms, Update(robot_, ++last_, {.id = "e", .detail_json = "{}"})));
    Commit(records);
    storage::Batch batch;
    batch.presence_session = model::SessionId({0xEE});
    batch.presence = {{robot_, model::Presence::kOnline, Time(after_ms), ++presence_, held_since_}};
    batch.gaps = {Gap(last_ * 100, last_ * 100 + 1)};
    batch.gaps.front().seen_at = Time(after_ms);
    Commit(batch);
  }
  std::vector<std::size_t> Counts() {
    return {History().size(),      Events().size(),     Messages().size(),
            Reports().size(),      Runs().size(),       Changes().size(),
            ScopeUpdates().size(), Quarantine().size(), Gaps().size()};
  }

  model::Seq last_ = 0;
  model::Seq presence_ = 0;
};

TEST_P(RetentionContract, KeepsWholeDaysOfEachHistory) {
  storage::StoreRules rules;
  rules.retain_history = std::chrono::days(3);
  rules.retain_quarantine = std::chrono::days(2);
  Fresh(rules);
  CommitOneOfEach(-kDayMs - 1, "a");  // the last of its day
  CommitOneOfEach(-kDayMs, "b");      // the first of the next
  CommitOneOfEach(0, "c");
  EXPECT_THAT(Counts(), ElementsAre(3, 3, 3, 3, 3, 3, 3, 3, 3));
  // A moment before the second day after that of "a" has ended, nothing is too old.
  EXPECT_EQ(Retain(kDayMs - 1), 0U);
  EXPECT_GT(Retain(kDayMs), 0U);
  EXPECT_THAT(Counts(), ElementsAre(3, 3, 3, 3, 3, 3, 3, 2, 2));
  EXPECT_GT(Retain(2 * kDayMs), 0U);
  EXPECT_THAT(Counts(), ElementsAre(2, 2, 2, 2, 2, 2, 2, 1, 1));
  EXPECT_GT(Retain(100 * kDayMs), 0U);
  EXPECT_THAT(Counts(), ElementsAre(0, 0, 0, 0, 0, 0, 0, 0, 0));
  EXPECT_EQ(Retain(100 * kDayMs), 0U);
  // What is present or decides is no history.
  EXPECT_THAT(Active(), SizeIs(1));
  EXPECT_EQ(CursorNow(), last_);
  const auto robots = store_->reader().Robots(10);
  ASSERT_TRUE(robots.ok()) << robots.status();
  ASSERT_THAT(*robots, SizeIs(3)) << "those of Fresh";
  EXPECT_EQ(robots->front().last_presence, model::Presence::kOnline);
}

TEST_P(RetentionContract, ZeroKeepsAllForEver) {
  storage::StoreRules rules;
  rules.retain_history = milliseconds(0);
  rules.retain_quarantine = milliseconds(0);
  Fresh(rules);
  CommitOneOfEach(-10'000 * kDayMs, "a");
  EXPECT_EQ(Retain(0), 0U);
  EXPECT_THAT(Counts(), ElementsAre(1, 1, 1, 1, 1, 1, 1, 1, 1));
}

TEST_P(RetentionContract, AnOpenRunStaysAndAClosedOneGoesByItsLastReport) {
  Open();
  Commit({At(0, Good(1, Report("open", model::MissionStatus::kRunning))),
          At(0, Good(2, Report("late", model::MissionStatus::kRunning))),
          At(0, Good(3, Report("old", model::MissionStatus::kAborted))),
          At(50 * kDayMs, Good(4, Report("late", model::MissionStatus::kComplete)))});
  Retain(91 * kDayMs);
  std::vector<std::string> runs;
  for (const auto& run : Runs()) runs.push_back(run.run_id);
  EXPECT_THAT(runs, ElementsAre("late", "open"));
  EXPECT_THAT(Reports(), SizeIs(1));
  Retain(141 * kDayMs);
  EXPECT_THAT(Runs(), SizeIs(1));
}

TEST_P(RetentionContract, ANumberWhoseQuarantineWentIsADuplicate) {
  Open();
  Commit({Bad(1), Good(2)});
  storage::OpenRequest confirming = Request();
  confirming.settled_seq = 1;
  Open(confirming);
  Retain(15 * kDayMs);
  EXPECT_THAT(Quarantine(), IsEmpty());
  EXPECT_THAT(Commit({Bad(1)}), ElementsAre(storage::OutcomeKind::kDuplicate));
  EXPECT_THAT(Open().rejects, IsEmpty());
}

TEST_P(RetentionContract, ACallDeletesABoundedNumberOfRows) {
  Open();
  std::vector<storage::CommitRecord> records;
  // On a day for which no store has made room ahead.
  const std::int64_t old = -200 * kDayMs;
  for (model::Seq seq = 1; seq <= storage::kRetainRowsMax + 10; ++seq) {
    records.push_back(At(old, Good(seq)));
  }
  Commit(records);
  EXPECT_EQ(Retain(0), storage::kRetainRowsMax);
  EXPECT_THAT(Messages(), SizeIs(10));
  EXPECT_EQ(Retain(0), 10U);
}

TEST_P(RetentionContract, ANumberOfADayThatWentIsNotStoredAgain) {
  Open();
  Commit({Good(1), Good(2)});
  Retain(200 * kDayMs);
  EXPECT_THAT(Commit({At(200 * kDayMs, Good(2)), At(200 * kDayMs, Good(3))}),
              ElementsAre(storage::OutcomeKind::kDuplicate, storage::OutcomeKind::kStored));
  EXPECT_THAT(Messages(), SizeIs(1));
}

TEST_P(RetentionContract, AClockThatNobodyVouchesForDeletesNothing) {
  FakeTrust trust(false);
  storage::StoreRules rules;
  rules.clock = &trust;
  Fresh(rules);
  CommitOneOfEach(0, "a");
  EXPECT_EQ(Retain(100 * kDayMs), 0U);
  EXPECT_THAT(Counts(), ElementsAre(1, 1, 1, 1, 1, 1, 1, 1, 1));
  trust.Set(true);
  EXPECT_GT(Retain(100 * kDayMs), 0U);
  EXPECT_THAT(Counts(), ElementsAre(0, 0, 0, 0, 0, 0, 0, 0, 0));
}

INSTANTIATE_TEST_SUITE_P(Stores, RetentionContract, EveryStore(), NameOfKind);

}  // namespace
}  // namespace uplink::testing
