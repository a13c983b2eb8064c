#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/contract/store_under_test.h"
#include "tests/support/records.h"

namespace uplink::testing {

/// What every store does alike. One process, one robot and one session if a test names no other.
/// What it does is compiled once, since a dozen files of tests use it.
class StoreContract : public ::testing::TestWithParam<StoreKind> {
 protected:
  StoreContract();
  ~StoreContract() override;

  static constexpr std::int64_t kNowMs = 1'763'683'200'000;
  static constexpr std::uint8_t kProcess = 1;
  static constexpr std::uint8_t kOther = 2;

  static SystemTime Time(std::int64_t after_ms = 0) { return FromUnixMs(kNowMs + after_ms); }

  static storage::RobotRef Robot(const std::string& name = "a", const std::string& fleet = "f1");

  static model::SessionId Session(std::uint8_t number = 1) {
    return model::SessionId({0, 0xFF, '\'', number});
  }

  static model::Fault Fault(std::string fault_id, bool active = true);
  static model::Fault Cleared(std::string fault_id) { return Fault(std::move(fault_id), false); }

  static model::Message Note();

  /// A good record of the fixture's robot and session, committed under its hold.
  storage::CommitRecord Good(model::Seq seq, const model::Body& body) const;
  storage::CommitRecord Good(model::Seq seq) const;

  storage::CommitRecord With(model::Seq seq, model::Record good) const;

  storage::CommitRecord Bad(model::Seq seq, const std::string& payload = "bad bytes") const;
  static model::Rejection BadReason();
  /// Numbers of messages that were over their rate.
  storage::CommitRecord Limited(model::Seq first, model::Seq last) const;
  static model::Rejection RateReason();

  /// Of `robot`, or of what stands in its place.
  storage::CommitRecord Update(storage::RobotRef robot, model::Seq seq,
                               model::ScopeUpdate update) const;

  static storage::CommitRecord At(std::int64_t after_ms, storage::CommitRecord record);
  static storage::CommitRecord Of(storage::RobotRef robot, storage::CommitRecord record);

  storage::OpenRequest Request() const;

  /// Opens a stream and makes its hold that of the records that follow.
  storage::OpenResult Open(const storage::OpenRequest& request, std::uint8_t process = kProcess);
  storage::OpenResult Open() { return Open(Request()); }

  /// Opens as many other sessions as a robot may have, each later than the last: the fixture's,
  /// used longest ago, is forgotten.
  void EvictSession();

  /// Opens streams of other robots, too. Commit gives what comes of them under the fixture's hold
  /// their own.
  void OpenAlso(const std::vector<storage::RobotRef>& robots);

  /// An empty database, and streams of the fixture's robot and of the robots b and c.
  void Fresh(const storage::StoreRules& rules = {});

  std::vector<storage::Outcome> Commit(const storage::Batch& batch,
                                       std::uint8_t process = kProcess);
  std::vector<storage::OutcomeKind> Commit(std::vector<storage::CommitRecord> records,
                                           std::uint8_t process = kProcess);
  static std::vector<storage::OutcomeKind> KindsOf(const std::vector<storage::Outcome>& outcomes) {
    std::vector<storage::OutcomeKind> kinds;
    kinds.reserve(outcomes.size());
    for (const storage::Outcome& outcome : outcomes) kinds.push_back(outcome.kind);
    return kinds;
  }
  void CommitGaps(std::vector<storage::GapItem> gaps);
  storage::GapItem Gap(model::Seq first, model::Seq last) const;

  model::Seq CursorNow() { return Open().cursor; }

  std::vector<storage::FaultRow> History(const storage::HistoryQuery& query = {});
  std::vector<storage::FaultRow> Active(const storage::HistoryQuery& query = {});
  std::vector<storage::QuarantineRow> Quarantine(const storage::HistoryQuery& query = {});
  std::vector<storage::GapRow> Gaps(const storage::HistoryQuery& query = {});
  std::vector<storage::EventRow> Events(const storage::HistoryQuery& query = {});
  std::vector<storage::MessageRow> Messages(const storage::HistoryQuery& query = {});
  std::vector<storage::MissionRunRow> Runs(const storage::MissionsQuery& query = {});
  std::vector<storage::MissionReportRow> Reports(const storage::MissionsQuery& query = {});
  /// Those that have not expired `after_ms` after Time().
  std::vector<storage::ShapeRow> Shapes(std::int64_t after_ms = 0);
  std::vector<storage::ObjectRow> Objects(std::int64_t after_ms = 0);
  std::vector<storage::ScopeUpdateRow> ScopeUpdates(const storage::ScopeUpdatesQuery& query = {});
  std::vector<storage::PresenceRow> Changes(const storage::HistoryQuery& query = {});
  /// The latest rows of the fixture's robot, all kinds.
  std::vector<storage::LatestRow> LatestRows();
  static constexpr storage::LatestKindSet kAllLatest = storage::kAllLatestKinds;

  template <typename Row>
  static std::vector<Row> RowsOf(absl::StatusOr<storage::Page<Row>> page) {
    EXPECT_TRUE(page.ok()) << page.status();
    if (!page.ok()) return {};
    return std::move(page->rows);
  }

  /// With the holds of OpenAlso.
  [[nodiscard]] storage::Batch Held(storage::Batch batch) const;

  std::unique_ptr<StoreUnderTest> store_;
  storage::RobotRef robot_;
  model::SessionId session_ = Session();
  storage::Epoch held_since_ = 0;
  /// Of OpenAlso, by RURI.
  std::map<std::string, storage::Epoch, std::less<>> also_held_;
  /// All that held_since_ was by Open.
  std::set<storage::Epoch> fixtures_holds_;
};

/// The kinds of store that pass the suite, word for word.
[[nodiscard]] inline auto EveryStore() {
  return ::testing::Values(FakeKind(), SqliteKind(), PostgresKind());
}

[[nodiscard]] inline std::string NameOfKind(const ::testing::TestParamInfo<StoreKind>& kind) {
  return kind.param.name;
}

}  // namespace uplink::testing
