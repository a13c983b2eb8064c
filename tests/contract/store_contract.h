#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/contract/store_under_test.h"
#include "tests/support/records.h"

namespace uplink::testing {

/// What every store does alike. One process, one robot and one session if a test names no other.
class StoreContract : public ::testing::TestWithParam<StoreKind> {
 protected:
  static constexpr std::int64_t kNowMs = 1'763'683'200'000;
  static constexpr std::uint8_t kProcess = 1;
  static constexpr std::uint8_t kOther = 2;

  static SystemTime Time(std::int64_t after_ms = 0) { return FromUnixMs(kNowMs + after_ms); }

  static storage::RobotRef Robot(const std::string& name = "a", const std::string& fleet = "f1") {
    return std::make_shared<const model::RobotId>(model::RobotId{"rcan://robots/" + name, fleet});
  }

  static model::SessionId Session(std::uint8_t number = 1) {
    return model::SessionId({0, 0xFF, '\'', number});
  }

  static model::Fault Fault(std::string fault_id, bool active = true) {
    model::Fault fault;
    fault.unix_time_ms = kNowMs - 5;
    fault.fault_id = std::move(fault_id);
    fault.source = "drive";
    fault.severity = model::FaultSeverity::kMajor;
    fault.active = active;
    fault.category = "motor";
    fault.description = "too hot";
    fault.suggested_action = "wait";
    return fault;
  }
  static model::Fault Cleared(std::string fault_id) { return Fault(std::move(fault_id), false); }

  static model::Message Note() {
    model::Message message;
    message.message = "hello";
    return message;
  }

  /// A good record of the fixture's robot and session, committed under its hold.
  storage::CommitRecord Good(model::Seq seq, const model::Body& body) const {
    return With(seq, test::RecordOf(body));
  }
  storage::CommitRecord Good(model::Seq seq) const { return Good(seq, Note()); }

  storage::CommitRecord With(model::Seq seq, model::Record good) const {
    return {robot_, session_, seq, held_since_, Time(), std::move(good), "bytes", 5};
  }

  storage::CommitRecord Bad(model::Seq seq, const std::string& payload = "bad bytes") const {
    const std::uint64_t payload_bytes = payload.size();
    return {robot_,  session_,     seq, held_since_, Time(), storage::QuarantineItem{BadReason()},
            payload, payload_bytes};
  }
  static model::Rejection BadReason() {
    return {model::RejectReason::kOutOfRange, "battery.socPct", "socPct is 140, at most 105"};
  }

  static storage::CommitRecord At(std::int64_t after_ms, storage::CommitRecord record) {
    record.received_at = Time(after_ms);
    return record;
  }
  static storage::CommitRecord Of(storage::RobotRef robot, storage::CommitRecord record) {
    record.robot = std::move(robot);
    return record;
  }

  storage::OpenRequest Request() const { return {robot_, session_, 0, Time(), {}}; }

  /// Opens a stream and makes its hold that of the records that follow.
  storage::OpenResult Open(const storage::OpenRequest& request, std::uint8_t process = kProcess) {
    auto results = store_->Process(process).OpenStreams({&request, 1});
    EXPECT_TRUE(results.ok()) << results.status();
    if (!results.ok() || results->size() != 1) return {};
    held_since_ = results->front().held_since;
    return results->front();
  }
  storage::OpenResult Open() { return Open(Request()); }

  /// An empty database, and a stream of the fixture's robot.
  void Fresh(const storage::StoreRules& rules = {}) {
    store_ = nullptr;
    store_ = GetParam().make(rules);
    Open();
  }

  std::vector<storage::Outcome> Commit(const storage::Batch& batch,
                                       std::uint8_t process = kProcess) {
    auto outcomes = store_->Process(process).Commit(batch);
    EXPECT_TRUE(outcomes.ok()) << outcomes.status();
    if (!outcomes.ok()) return {};
    EXPECT_EQ(outcomes->size(), batch.records.size());
    return *std::move(outcomes);
  }
  std::vector<storage::OutcomeKind> Commit(std::vector<storage::CommitRecord> records,
                                           std::uint8_t process = kProcess) {
    storage::Batch batch;
    batch.records = std::move(records);
    std::vector<storage::OutcomeKind> kinds;
    for (const storage::Outcome& outcome : Commit(batch, process)) kinds.push_back(outcome.kind);
    return kinds;
  }
  void CommitGaps(std::vector<storage::GapItem> gaps) {
    storage::Batch batch;
    batch.gaps = std::move(gaps);
    EXPECT_TRUE(Commit(batch).empty());
  }
  storage::GapItem Gap(model::Seq first, model::Seq last) const {
    return {robot_, session_, first, last, held_since_, Time()};
  }

  model::Seq CursorNow() { return Open().cursor; }

  std::vector<storage::FaultRow> History(const storage::HistoryQuery& query = {}) {
    return RowsOf(store_->reader().FaultHistory(query));
  }
  std::vector<storage::FaultRow> Active(const storage::HistoryQuery& query = {}) {
    return RowsOf(store_->reader().FaultsActive(query));
  }
  std::vector<storage::QuarantineRow> Quarantine(const storage::HistoryQuery& query = {}) {
    return RowsOf(store_->reader().Quarantine(query));
  }
  std::vector<storage::GapRow> Gaps(const storage::HistoryQuery& query = {}) {
    return RowsOf(store_->reader().Gaps(query));
  }

  std::vector<storage::EventRow> Events(const storage::HistoryQuery& query = {}) {
    return RowsOf(store_->reader().Events(query));
  }
  std::vector<storage::MessageRow> Messages(const storage::HistoryQuery& query = {}) {
    return RowsOf(store_->reader().Messages(query));
  }
  std::vector<storage::MissionRunRow> Runs(const storage::MissionsQuery& query = {}) {
    return RowsOf(store_->reader().MissionRuns(query));
  }
  std::vector<storage::MissionReportRow> Reports(const storage::MissionsQuery& query = {}) {
    return RowsOf(store_->reader().MissionReports(query));
  }
  /// Those that have not expired `after_ms` after Time().
  std::vector<storage::ShapeRow> Shapes(std::int64_t after_ms = 0) {
    return RowsOf(store_->reader().Shapes({{}, Time(after_ms), false}));
  }
  std::vector<storage::ObjectRow> Objects(std::int64_t after_ms = 0) {
    return RowsOf(store_->reader().Objects({{}, Time(after_ms), false}));
  }
  std::vector<storage::PresenceRow> Changes(const storage::HistoryQuery& query = {}) {
    return RowsOf(store_->reader().PresenceChanges(query));
  }
  /// The latest rows of the fixture's robot, all kinds.
  std::vector<storage::LatestRow> LatestRows() {
    auto latest = store_->reader().Latest({&robot_->ruri, 1}, kAllLatest);
    EXPECT_TRUE(latest.ok()) << latest.status();
    if (!latest.ok()) return {};
    EXPECT_EQ(latest->complete, 1U);
    return std::move(latest->rows);
  }
  static constexpr std::uint32_t kAllLatest = (1U << storage::kLatestKinds) - 1;

  template <typename Row>
  static std::vector<Row> RowsOf(absl::StatusOr<storage::Page<Row>> page) {
    EXPECT_TRUE(page.ok()) << page.status();
    if (!page.ok()) return {};
    return std::move(page->rows);
  }

  std::unique_ptr<StoreUnderTest> store_ = GetParam().make({});
  storage::RobotRef robot_ = Robot();
  model::SessionId session_ = Session();
  storage::Epoch held_since_ = 0;
};

/// The kinds of store that pass the suite, word for word.
[[nodiscard]] inline auto EveryStore() {
  return ::testing::Values(FakeKind(), SqliteKind(), PostgresKind());
}

[[nodiscard]] inline std::string NameOfKind(const ::testing::TestParamInfo<StoreKind>& kind) {
  return kind.param.name;
}

}  // namespace uplink::testing
