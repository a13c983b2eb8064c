#include "tests/contract/store_contract.h"

#include <algorithm>

#include "schema/base/check.h"
#include "storage/bounds.h"

namespace uplink::testing {

void RemoveFrom(storage::RobotRemoval& removal, const std::string& ruri) {
  const auto hold = removal.HoldOf(ruri);
  UPLINK_CHECK(hold.ok(), hold.status().ToString());
  const auto removed = removal.Remove(ruri, *hold ? (*hold)->epoch : 0);
  UPLINK_CHECK(removed.ok() && *removed, "the robot's epoch is that");
}

StoreContract::StoreContract() : store_(GetParam().make({})), robot_(Robot()) {}

StoreContract::~StoreContract() = default;

storage::RobotRef StoreContract::Robot(const std::string& name, const std::string& fleet) {
  return std::make_shared<const model::RobotId>(model::RobotId{"rcan://robots/" + name, fleet});
}

model::Fault StoreContract::Fault(std::string fault_id, bool active) {
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

model::Message StoreContract::Note() {
  model::Message message;
  message.message = "hello";
  return message;
}

storage::CommitRecord StoreContract::Good(model::Seq seq, const model::Body& body) const {
  return With(seq, test::RecordOf(body));
}

storage::CommitRecord StoreContract::Good(model::Seq seq) const { return Good(seq, Note()); }

storage::CommitRecord StoreContract::With(model::Seq seq, model::Record good) const {
  return {robot_, session_, seq, held_since_, Time(), std::move(good), "bytes", 5};
}

storage::CommitRecord StoreContract::Bad(model::Seq seq, const std::string& payload) const {
  const std::uint64_t payload_bytes = payload.size();
  return {robot_,  session_,     seq, held_since_, Time(), storage::QuarantineItem{BadReason()},
          payload, payload_bytes};
}

storage::CommitRecord StoreContract::Update(storage::RobotRef robot, model::Seq seq,
                                            model::ScopeUpdate update) const {
  return {std::move(robot), session_, seq, held_since_, Time(), std::move(update), "", 0};
}

model::Rejection StoreContract::BadReason() {
  return {model::RejectReason::kOutOfRange, "battery.socPct", "socPct is 140, at most 105"};
}

storage::CommitRecord StoreContract::Limited(model::Seq first, model::Seq last) const {
  return {robot_, session_, last, held_since_, Time(), storage::LimitedRange{first, RateReason()},
          "",     0};
}

model::Rejection StoreContract::RateReason() {
  return {model::RejectReason::kRateLimited, "", "more than 50 per second, after 2000 at once"};
}

storage::CommitRecord StoreContract::At(std::int64_t after_ms, storage::CommitRecord record) {
  record.received_at = Time(after_ms);
  return record;
}

storage::CommitRecord StoreContract::Of(storage::RobotRef robot, storage::CommitRecord record) {
  record.robot = std::move(robot);
  return record;
}

storage::OpenRequest StoreContract::Request() const { return {robot_, session_, 0, Time(), {}}; }

storage::OpenResult StoreContract::Open(const storage::OpenRequest& request, std::uint8_t process) {
  auto results = store_->Process(process).OpenStreams({&request, 1});
  EXPECT_TRUE(results.ok()) << results.status();
  if (!results.ok() || results->size() != 1) return {};
  held_since_ = results->front().held_since;
  fixtures_holds_.insert(held_since_);
  return results->front();
}

void StoreContract::EvictSession() {
  for (std::uint8_t i = 1; i <= storage::kSessionsPerRobotMax; ++i) {
    storage::OpenRequest request = Request();
    request.session = Session(static_cast<std::uint8_t>(100 + i));
    request.at = Time(i);
    Open(request);
  }
}

void StoreContract::OpenAlso(const std::vector<storage::RobotRef>& robots) {
  std::vector<storage::OpenRequest> requests(robots.size(), Request());
  for (std::size_t i = 0; i < robots.size(); ++i) requests[i].robot = robots[i];
  const auto results = store_->Process(kProcess).OpenStreams(requests);
  ASSERT_TRUE(results.ok()) << results.status();
  for (std::size_t i = 0; i < robots.size(); ++i) {
    also_held_[robots[i]->ruri] = (*results)[i].held_since;
  }
}

storage::Batch StoreContract::Held(storage::Batch batch) const {
  const auto give = [this](auto& items) {
    for (auto& item : items) {
      const auto own = also_held_.find(item.robot->ruri);
      const bool is_fixtures = item.robot->ruri == robot_->ruri;
      if (own == also_held_.end() || is_fixtures) continue;
      if (!fixtures_holds_.contains(item.held_since)) continue;
      item.held_since = own->second;
    }
  };
  give(batch.records);
  give(batch.gaps);
  give(batch.presence);
  return batch;
}

void StoreContract::Fresh(const storage::StoreRules& rules) {
  store_ = nullptr;
  store_ = GetParam().make(rules);
  also_held_.clear();
  Open();
  OpenAlso({Robot("b"), Robot("c")});
}

std::vector<storage::Outcome> StoreContract::Commit(const storage::Batch& batch,
                                                    std::uint8_t process) {
  auto outcomes = store_->Process(process).Commit(Held(batch));
  EXPECT_TRUE(outcomes.ok()) << outcomes.status();
  if (!outcomes.ok()) return {};
  EXPECT_EQ(outcomes->size(), batch.records.size() + batch.presence.size());
  return *std::move(outcomes);
}

std::vector<storage::OutcomeKind> StoreContract::Commit(std::vector<storage::CommitRecord> records,
                                                        std::uint8_t process) {
  storage::Batch batch;
  batch.records = std::move(records);
  std::vector<storage::OutcomeKind> kinds;
  for (const storage::Outcome& outcome : Commit(batch, process)) kinds.push_back(outcome.kind);
  return kinds;
}

void StoreContract::CommitGaps(std::vector<storage::GapItem> gaps) {
  storage::Batch batch;
  batch.gaps = std::move(gaps);
  EXPECT_TRUE(Commit(batch).empty());
}

storage::GapItem StoreContract::Gap(model::Seq first, model::Seq last) const {
  return {robot_, session_, first, last, held_since_, Time()};
}

std::vector<storage::FaultRow> StoreContract::History(const storage::HistoryQuery& query) {
  return RowsOf(store_->reader().FaultHistory({.rows = query}));
}

std::vector<storage::FaultRow> StoreContract::Active(const storage::HistoryQuery& query) {
  return RowsOf(store_->reader().FaultsActive({.rows = query}));
}

std::vector<storage::QuarantineRow> StoreContract::Quarantine(const storage::HistoryQuery& query) {
  return RowsOf(store_->reader().Quarantine({.rows = query}));
}

std::vector<storage::GapRow> StoreContract::Gaps(const storage::HistoryQuery& query) {
  return RowsOf(store_->reader().Gaps(query));
}

std::vector<storage::EventRow> StoreContract::Events(const storage::HistoryQuery& query) {
  return RowsOf(store_->reader().Events({.rows = query}));
}

std::vector<storage::MessageRow> StoreContract::Messages(const storage::HistoryQuery& query) {
  return RowsOf(store_->reader().Messages({.rows = query}));
}

std::vector<storage::MissionRunRow> StoreContract::Runs(const storage::MissionsQuery& query) {
  return RowsOf(store_->reader().MissionRuns(query));
}

std::vector<storage::MissionReportRow> StoreContract::Reports(const storage::MissionsQuery& query) {
  return RowsOf(store_->reader().MissionReports(query));
}

std::vector<storage::ShapeRow> StoreContract::Shapes(std::int64_t after_ms) {
  return RowsOf(store_->reader().Shapes({{}, Time(after_ms), false}));
}

std::vector<storage::ObjectRow> StoreContract::Objects(std::int64_t after_ms) {
  return RowsOf(store_->reader().Objects({{}, Time(after_ms), false}));
}

std::vector<storage::ScopeUpdateRow> StoreContract::ScopeUpdates(
    const storage::ScopeUpdatesQuery& query) {
  return RowsOf(store_->reader().ScopeUpdates(query));
}

std::vector<storage::PresenceRow> StoreContract::Changes(const storage::HistoryQuery& query) {
  return RowsOf(store_->reader().PresenceChanges(query));
}

std::vector<storage::LatestRow> StoreContract::LatestRows() {
  auto latest = store_->reader().Latest({&robot_->ruri, 1}, kAllLatest);
  EXPECT_TRUE(latest.ok()) << latest.status();
  if (!latest.ok()) return {};
  EXPECT_EQ(latest->complete, 1U);
  return std::move(latest->rows);
}

}  // namespace uplink::testing
