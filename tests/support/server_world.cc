#include "tests/support/server_world.h"

#include <utility>

#include "metrics/exposition.h"
#include "schema/base/check.h"
#include "tests/support/records.h"

namespace uplink::testing {
namespace {

void AddRelaySamples(metrics::Exposition& page) {
  for (const std::string_view cause : {"full", "draining", "identity"}) {
    page.Add(metrics::MetricId::kStreamsRefused, 0, {cause});
  }
  page.Add(metrics::MetricId::kFinishTimeouts, 0);
  page.Add(metrics::MetricId::kWakes, 0);
}

}  // namespace

absl::Status SwitchedReader::Enter() {
  std::unique_lock lock(mutex_);
  ++calls_;
  ++inside_;
  changed_.notify_all();
  changed_.wait(lock, [this] { return !held_; });
  --inside_;
  return away_ ? absl::UnavailableError("the test took the store away") : absl::OkStatus();
}

void SwitchedReader::SetAway(bool away) {
  const std::lock_guard lock(mutex_);
  away_ = away;
}

void SwitchedReader::Hold() {
  const std::lock_guard lock(mutex_);
  held_ = true;
}

void SwitchedReader::Release() {
  const std::lock_guard lock(mutex_);
  held_ = false;
  changed_.notify_all();
}

bool SwitchedReader::WaitUntilHeld(milliseconds deadline) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, deadline, [this] { return held_ && inside_ > 0; });
}

int SwitchedReader::calls() const {
  const std::lock_guard lock(mutex_);
  return calls_;
}

absl::StatusOr<std::vector<storage::RobotRow>> SwitchedReader::Robots(std::uint32_t robots_max) {
  if (absl::Status here = Enter(); !here.ok()) return here;
  return reader_.Robots(robots_max);
}

absl::StatusOr<storage::Page<storage::FaultRow>> SwitchedReader::FaultsActive(
    const storage::HistoryQuery& query) {
  if (absl::Status here = Enter(); !here.ok()) return here;
  return reader_.FaultsActive(query);
}

absl::StatusOr<storage::Page<storage::FaultRow>> SwitchedReader::FaultHistory(
    const storage::HistoryQuery& query) {
  if (absl::Status here = Enter(); !here.ok()) return here;
  return reader_.FaultHistory(query);
}

absl::StatusOr<std::vector<storage::ActiveFaults>> SwitchedReader::ActiveFaultCounts(
    std::span<const std::string> ruris) {
  if (absl::Status here = Enter(); !here.ok()) return here;
  return reader_.ActiveFaultCounts(ruris);
}

absl::StatusOr<storage::Page<storage::QuarantineRow>> SwitchedReader::Quarantine(
    const storage::HistoryQuery& query) {
  if (absl::Status here = Enter(); !here.ok()) return here;
  return reader_.Quarantine(query);
}

absl::StatusOr<storage::Page<storage::GapRow>> SwitchedReader::Gaps(
    const storage::HistoryQuery& query) {
  if (absl::Status here = Enter(); !here.ok()) return here;
  return reader_.Gaps(query);
}

ServerWorld::ServerWorld()
    : journal(store, journal_limits, clock, ledgers.NewPage(), journal_probe),
      queries({clock, fleet, reader, journal, ledgers, sessions, "9.9.9"}),
      monitor({clock, fleet, journal, journal_probe, sessions, journal_limits,
               clock.System() + std::chrono::hours(24 * 365)}),
      scrape({.clock = clock,
              .fleet = fleet,
              .journal = journal,
              .journal_probe = journal_probe,
              .sessions = sessions,
              .ledgers = ledgers,
              .monitor = monitor,
              .http = http_probe,
              .journal_limits = journal_limits,
              .http_connections_max = 4,
              .version = "9.9.9",
              .add_relay = AddRelaySamples}),
      site(queries, monitor, scrape) {}

fleet::Robot& ServerWorld::AddRobot(const std::string& ruri, const std::string& fleet_name) {
  const absl::StatusOr<fleet::Robot*> robot = fleet.FindOrAdmit({ruri, fleet_name});
  UPLINK_CHECK(robot.ok(), "the test's robots fit the fleet");
  return **robot;
}

model::SessionId ServerWorld::session() {
  return *model::SessionId::FromHex("000102030405060708090a0b0c0d0e0f");
}

storage::CommitRecord ServerWorld::Next(const std::string& ruri) {
  fleet::Robot* robot = fleet.Find(ruri);
  UPLINK_CHECK(robot != nullptr, "AddRobot comes first");
  const storage::OpenRequest open{.robot = robot->id(), .session = session(), .at = clock.System()};
  const auto opened = store.OpenStreams(std::span(&open, 1));
  UPLINK_CHECK(opened.ok(), "the fake store opens");
  storage::CommitRecord record{.robot = robot->id(),
                               .session = session(),
                               .seq = ++last_seq_,
                               .held_since = opened->front().held_since,
                               .received_at = clock.System(),
                               .content = storage::QuarantineItem{}};
  return record;
}

void ServerWorld::Commit(const std::string& ruri, std::vector<storage::CommitRecord> records,
                         std::vector<storage::GapItem> gaps) {
  const auto outcomes = store.Commit({std::move(records), std::move(gaps)});
  UPLINK_CHECK(outcomes.ok(), ruri);
}

void ServerWorld::CommitFault(const std::string& ruri, const model::Fault& fault) {
  storage::CommitRecord record = Next(ruri);
  record.content = uplink::test::RecordOf(fault);
  std::vector<storage::CommitRecord> records;
  records.push_back(std::move(record));
  Commit(ruri, std::move(records));
}

void ServerWorld::CommitQuarantine(const std::string& ruri, const model::Rejection& rejection,
                                   const std::string& payload) {
  storage::CommitRecord record = Next(ruri);
  record.content = storage::QuarantineItem{rejection};
  record.payload = payload;
  record.payload_bytes = payload.size();
  std::vector<storage::CommitRecord> records;
  records.push_back(std::move(record));
  Commit(ruri, std::move(records));
}

void ServerWorld::CommitGap(const std::string& ruri, model::Seq first, model::Seq last) {
  const storage::CommitRecord like = Next(ruri);
  Commit(ruri, {},
         {{.robot = like.robot,
           .session = session(),
           .first = first,
           .last = last,
           .held_since = like.held_since,
           .seen_at = clock.System()}});
}

http::Response ServerWorld::Get(const std::string& target) const {
  return site.Resolve({http::Method::kGet, target}).run();
}

}  // namespace uplink::testing
