#include "tests/support/fake_store.h"

#include <utility>

#include "tests/support/fake_reader.h"

namespace uplink::testing {

FakeStore::FakeStore(FakeDatabase& database, const storage::ProcessId& process,
                     const storage::StoreRules& rules)
    : database_(database), process_(process), store_rules_(rules) {}

FakeStore::~FakeStore() = default;

absl::StatusOr<std::vector<storage::OpenResult>> FakeStore::OpenStreams(
    std::span<const storage::OpenRequest> requests) {
  Fate fate = Begin({&any_order_, &open_order_}, opens_);
  if (fate.fail_before) return std::move(fate.status);
  std::vector<storage::OpenResult> results = database_.OpenStreams(process_, requests);
  if (fate.fail_after) return std::move(fate.status);
  return results;
}

absl::StatusOr<std::vector<storage::AdoptResult>> FakeStore::Adopt(
    std::span<const storage::AdoptRequest> requests) {
  Fate fate = Begin({&any_order_}, adopts_);
  if (fate.fail_before) return std::move(fate.status);
  std::vector<storage::AdoptResult> results = database_.Adopt(process_, requests);
  if (fate.fail_after) return std::move(fate.status);
  return results;
}

absl::StatusOr<std::vector<storage::Outcome>> FakeStore::Commit(const storage::Batch& batch) {
  Fate fate = Begin({&any_order_, &commit_order_}, commits_);
  if (fate.fail_before) return std::move(fate.status);
  std::vector<storage::Outcome> outcomes =
      database_.Commit(process_, batch, fate.rules, store_rules_);
  if (fate.fail_after) return std::move(fate.status);
  return outcomes;
}

absl::StatusOr<storage::Swept> FakeStore::Sweep(SystemTime now) {
  Fate fate = Begin({&sweep_order_}, sweeps_);
  if (fate.fail_before) return std::move(fate.status);
  const bool vouched = storage::Vouches(store_rules_.clock, now);
  const storage::Swept swept = {.items = vouched ? database_.Sweep(now) : 0,
                                .changes = database_.SweepChanges()};
  if (fate.fail_after) return std::move(fate.status);
  return swept;
}

absl::StatusOr<std::size_t> FakeStore::CloseRuns(SystemTime now) {
  Fate fate = Begin({&sweep_order_}, closes_);
  if (fate.fail_before) return std::move(fate.status);
  const bool vouched = storage::Vouches(store_rules_.clock, now);
  const std::size_t closed = vouched ? database_.CloseRuns(now) : 0;
  if (fate.fail_after) return std::move(fate.status);
  return closed;
}

std::size_t FakeStore::TakeRunsClosed() {
  const std::size_t closed = database_.runs_closed();
  const std::lock_guard lock(mutex_);
  return closed - std::exchange(runs_closed_taken_, closed);
}

absl::StatusOr<storage::Trimmed> FakeStore::TrimQuarantine(std::span<const std::string> ruris) {
  Fate fate = Begin({&any_order_, &trim_order_}, trims_);
  if (fate.fail_before) return std::move(fate.status);
  storage::Trimmed trimmed = database_.TrimQuarantine(ruris);
  if (fate.fail_after) return std::move(fate.status);
  return trimmed;
}

absl::StatusOr<storage::Erased> FakeStore::Retain(SystemTime now) {
  Fate fate = Begin({&retain_order_}, retains_);
  if (fate.fail_before) return std::move(fate.status);
  const bool vouched = storage::Vouches(store_rules_.clock, now);
  const storage::Erased erased = vouched ? database_.Retain(now, store_rules_) : storage::Erased();
  if (fate.fail_after) return std::move(fate.status);
  return erased;
}

absl::StatusOr<std::vector<std::size_t>> FakeStore::Checkpoint(
    std::span<const storage::LiveRow> rows) {
  Fate fate = Begin({&checkpoint_order_}, checkpoints_);
  if (fate.fail_before) return std::move(fate.status);
  std::vector<std::size_t> passed_over = database_.Checkpoint(process_, rows);
  if (fate.fail_after) return std::move(fate.status);
  return passed_over;
}

bool FakeStore::InDoubt() const {
  const std::lock_guard lock(mutex_);
  return in_doubt_;
}

absl::StatusOr<std::vector<storage::FoundRobot>> FakeStore::Compare(
    std::span<const storage::ToldRobot> robots) {
  Fate fate = Begin({&any_order_}, compares_);
  if (fate.fail_before || fate.fail_after) return std::move(fate.status);
  {
    const std::lock_guard lock(mutex_);
    if (compares_ == break_at_compare_) return absl::UnavailableError("the connection broke");
  }
  return database_.Compare(process_, robots);
}

void FakeStore::EndDoubt() {
  const std::lock_guard lock(mutex_);
  in_doubt_ = false;
}

void FakeStore::BreakAtCompare(std::uint64_t calls) {
  const std::lock_guard lock(mutex_);
  break_at_compare_ = compares_ + calls;
}

void FakeStore::Break() {
  const std::lock_guard lock(mutex_);
  in_doubt_ = true;
}

FakeStore::Fate FakeStore::Begin(std::initializer_list<Order*> orders, std::uint64_t& calls) {
  std::unique_lock lock(mutex_);
  ++waiting_;
  changed_.notify_all();
  changed_.wait(lock, [this] { return !blocked_; });
  --waiting_;
  ++calls;
  Fate fate;
  fate.rules = rules_;
  if (in_doubt_ && &calls != &compares_) {
    fate.fail_before = true;
    fate.status = absl::UnavailableError("what the store has is compared first");
    return fate;
  }
  for (Order* const from : orders) {
    if (from->before > 0) {
      --from->before;
      fate.fail_before = true;
    } else if (from->after > 0) {
      --from->after;
      fate.fail_after = true;
    } else {
      continue;
    }
    fate.status = from->status;
    break;
  }
  return fate;
}

void FakeStore::Add(Order& order, std::uint32_t calls, FailAt at, const absl::Status& status) {
  const std::lock_guard lock(mutex_);
  (at == FailAt::kBefore ? order.before : order.after) += calls;
  order.status = status;
}

void FakeStore::FailNext(std::uint32_t calls, FailAt at, const absl::Status& status) {
  Add(any_order_, calls, at, status);
}

void FakeStore::FailNextCommits(std::uint32_t calls, FailAt at, const absl::Status& status) {
  Add(commit_order_, calls, at, status);
}

void FakeStore::FailNextOpens(std::uint32_t calls, FailAt at, const absl::Status& status) {
  Add(open_order_, calls, at, status);
}

void FakeStore::FailNextSweeps(std::uint32_t calls, FailAt at, const absl::Status& status) {
  Add(sweep_order_, calls, at, status);
}

void FakeStore::FailNextTrims(std::uint32_t calls, FailAt at, const absl::Status& status) {
  Add(trim_order_, calls, at, status);
}

void FakeStore::FailNextRetains(std::uint32_t calls, FailAt at, const absl::Status& status) {
  Add(retain_order_, calls, at, status);
}

void FakeStore::FailNextCheckpoints(std::uint32_t calls, FailAt at, const absl::Status& status) {
  Add(checkpoint_order_, calls, at, status);
}

void FakeStore::Heal() {
  const std::lock_guard lock(mutex_);
  any_order_ = {};
  commit_order_ = {};
  open_order_ = {};
  sweep_order_ = {};
  trim_order_ = {};
  retain_order_ = {};
  checkpoint_order_ = {};
  blocked_ = false;
  changed_.notify_all();
}

void FakeStore::SetRules(FakeRules rules) {
  const std::lock_guard lock(mutex_);
  rules_ = std::move(rules);
}

void FakeStore::Block() {
  const std::lock_guard lock(mutex_);
  blocked_ = true;
}

void FakeStore::Release() {
  const std::lock_guard lock(mutex_);
  blocked_ = false;
  changed_.notify_all();
}

bool FakeStore::WaitUntilBlocked(milliseconds deadline) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, deadline, [this] { return blocked_ && waiting_ > 0; });
}

std::uint64_t FakeStore::commits() const {
  const std::lock_guard lock(mutex_);
  return commits_;
}

std::uint64_t FakeStore::opens() const {
  const std::lock_guard lock(mutex_);
  return opens_;
}

std::uint64_t FakeStore::adopts() const {
  const std::lock_guard lock(mutex_);
  return adopts_;
}

std::uint64_t FakeStore::sweeps() const {
  const std::lock_guard lock(mutex_);
  return sweeps_;
}

std::uint64_t FakeStore::trims() const {
  const std::lock_guard lock(mutex_);
  return trims_;
}

std::uint64_t FakeStore::compares() const {
  const std::lock_guard lock(mutex_);
  return compares_;
}

std::uint64_t FakeStore::checkpoints() const {
  const std::lock_guard lock(mutex_);
  return checkpoints_;
}

absl::StatusOr<std::vector<storage::RobotRow>> FakeStore::Robots(std::uint32_t robots_max) {
  return FakeReader(database_).Robots(robots_max);
}

absl::StatusOr<std::size_t> FakeStore::RobotCount() { return FakeReader(database_).RobotCount(); }

absl::StatusOr<std::vector<std::string>> FakeStore::FleetsBeyondAscii(std::uint32_t fleets_max) {
  return FakeReader(database_).FleetsBeyondAscii(fleets_max);
}

// NOLINTBEGIN(bugprone-macro-parentheses): the arguments are names of types and functions
#define UPLINK_LIST(Name, number, Row, Query, retained)                                      \
  absl::StatusOr<storage::Page<storage::Row>> FakeStore::Name(const storage::Query& query) { \
    return FakeReader(database_).Name(query);                                                \
  }
UPLINK_LISTS(UPLINK_LIST)
#undef UPLINK_LIST
// NOLINTEND(bugprone-macro-parentheses)

absl::StatusOr<std::vector<storage::DroppedRow>> FakeStore::QuarantineDropped(
    const std::string& ruri) {
  return FakeReader(database_).QuarantineDropped(ruri);
}

absl::StatusOr<std::vector<storage::StoredReject>> FakeStore::Rejects(
    const storage::RejectsQuery& query) {
  return FakeReader(database_).Rejects(query);
}

absl::StatusOr<std::vector<storage::ActiveFaults>> FakeStore::ActiveFaultCounts(
    std::span<const std::string> ruris) {
  return FakeReader(database_).ActiveFaultCounts(ruris);
}

absl::StatusOr<storage::Reader::LatestRows> FakeStore::Latest(std::span<const std::string> ruris,
                                                              storage::LatestKindSet kinds) {
  return FakeReader(database_).Latest(ruris, kinds);
}

absl::StatusOr<storage::Reader::LiveRows> FakeStore::LiveOf(std::span<const std::string> ruris) {
  return FakeReader(database_).LiveOf(ruris);
}

}  // namespace uplink::testing
