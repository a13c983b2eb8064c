#include "tests/support/fake_store.h"

namespace uplink::testing {

absl::StatusOr<std::vector<storage::OpenResult>> FakeStore::OpenStreams(
    std::span<const storage::OpenRequest> requests) {
  return Do({Orders::kAny, Orders::kOpens}, Call::kOpen,
            [&](const FakeRules& /*rules*/) { return database_.OpenStreams(process_, requests); });
}

absl::StatusOr<std::vector<storage::AdoptResult>> FakeStore::Adopt(
    std::span<const storage::AdoptRequest> requests) {
  return Do({Orders::kAny}, Call::kAdopt,
            [&](const FakeRules& /*rules*/) { return database_.Adopt(process_, requests); });
}

absl::StatusOr<std::vector<storage::ClaimResult>> FakeStore::ClaimDrones(
    std::span<const storage::ClaimRequest> requests) {
  return Do({Orders::kAny, Orders::kClaims}, Call::kClaim,
            [&](const FakeRules& /*rules*/) { return database_.ClaimDrones(process_, requests); });
}

absl::StatusOr<std::vector<storage::Outcome>> FakeStore::Commit(const storage::Batch& batch) {
  return Do({Orders::kAny, Orders::kCommits}, Call::kCommit, [&](const FakeRules& rules) {
    return database_.Commit(process_, batch, rules, store_rules_);
  });
}

absl::StatusOr<storage::Swept> FakeStore::Sweep(SystemTime now) {
  return Do({Orders::kSweeps}, Call::kSweep, [&](const FakeRules& /*rules*/) {
    const bool vouched = storage::Vouches(store_rules_.clock, now);
    return storage::Swept{.items = vouched ? database_.Sweep(now) : 0,
                          .changes = database_.SweepChanges()};
  });
}

absl::StatusOr<std::size_t> FakeStore::CloseRuns(SystemTime now) {
  return Do({Orders::kSweeps}, Call::kCloseRuns, [&](const FakeRules& /*rules*/) {
    const bool vouched = storage::Vouches(store_rules_.clock, now);
    return vouched ? database_.CloseRuns(now) : std::size_t{0};
  });
}

absl::StatusOr<std::vector<storage::ProcessId>> FakeStore::ProcessesWithOpenConnections() {
  return Do({Orders::kSweeps}, Call::kOpenProcesses,
            [&](const FakeRules& /*rules*/) { return database_.OpenProcesses(process_); });
}

absl::StatusOr<std::size_t> FakeStore::EndConnections(const storage::ProcessId& process,
                                                      SystemTime now) {
  return Do({Orders::kSweeps}, Call::kEndConnections,
            [&](const FakeRules& /*rules*/) { return database_.EndConnections(process, now); });
}

std::size_t FakeStore::TakeRunsClosed() {
  const std::size_t closed = database_.runs_closed();
  const std::lock_guard lock(mutex_);
  return closed - std::exchange(runs_closed_taken_, closed);
}

absl::StatusOr<storage::Trimmed> FakeStore::TrimQuarantine(std::span<const std::string> ruris) {
  return Do({Orders::kAny, Orders::kTrims}, Call::kTrim,
            [&](const FakeRules& /*rules*/) { return database_.TrimQuarantine(ruris); });
}

absl::StatusOr<storage::Erased> FakeStore::Retain(SystemTime now) {
  return Do({Orders::kRetains}, Call::kRetain, [&](const FakeRules& /*rules*/) {
    const bool vouched = storage::Vouches(store_rules_.clock, now);
    return vouched ? database_.Retain(now, store_rules_) : storage::Erased();
  });
}

absl::StatusOr<std::vector<std::size_t>> FakeStore::Checkpoint(
    std::span<const storage::LiveRow> rows) {
  return Do({Orders::kCheckpoints}, Call::kCheckpoint,
            [&](const FakeRules& /*rules*/) { return database_.Checkpoint(process_, rows); });
}

absl::StatusOr<std::vector<storage::FoundRobot>> FakeStore::Compare(
    std::span<const storage::ToldRobot> robots) {
  Fate fate = Begin({Orders::kAny}, Call::kCompare);
  if (fate.fail_before || fate.fail_after) return std::move(fate.status);
  {
    const std::lock_guard lock(mutex_);
    if (calls_[Call::kCompare] == break_at_compare_) {
      return absl::UnavailableError("the connection broke");
    }
  }
  return database_.Compare(process_, robots);
}

bool FakeStore::InDoubt() const {
  const std::lock_guard lock(mutex_);
  return in_doubt_;
}

void FakeStore::EndDoubt() {
  const std::lock_guard lock(mutex_);
  in_doubt_ = false;
}

void FakeStore::BreakAtCompare(std::uint64_t calls) {
  const std::lock_guard lock(mutex_);
  break_at_compare_ = calls_[Call::kCompare] + calls;
}

void FakeStore::Break() {
  const std::lock_guard lock(mutex_);
  in_doubt_ = true;
}

FakeStore::Fate FakeStore::Begin(std::initializer_list<Orders> orders, Call call) {
  std::unique_lock lock(mutex_);
  ++waiting_;
  changed_.notify_all();
  changed_.wait(lock, [this] { return !blocked_; });
  --waiting_;
  ++calls_[call];
  Fate fate;
  fate.rules = rules_;
  if (in_doubt_ && call != Call::kCompare) {
    fate.fail_before = true;
    fate.status = absl::UnavailableError("what the store has is compared first");
    return fate;
  }
  for (const Orders each : orders) {
    Order& from = orders_[each];
    if (from.before > 0) {
      --from.before;
      fate.fail_before = true;
    } else if (from.after > 0) {
      --from.after;
      fate.fail_after = true;
    } else {
      continue;
    }
    fate.status = from.status;
    break;
  }
  return fate;
}

void FakeStore::Add(Orders orders, std::uint32_t calls, FailAt at, const absl::Status& status) {
  const std::lock_guard lock(mutex_);
  Order& order = orders_[orders];
  (at == FailAt::kBefore ? order.before : order.after) += calls;
  order.status = status;
}

void FakeStore::Heal() {
  const std::lock_guard lock(mutex_);
  orders_.clear();
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

std::uint64_t FakeStore::Calls(Call call) const {
  const std::lock_guard lock(mutex_);
  const auto found = calls_.find(call);
  return found == calls_.end() ? 0 : found->second;
}

}  // namespace uplink::testing
