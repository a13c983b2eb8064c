#include <algorithm>
#include <variant>

#include <fmt/format.h>

#include "tests/simulation/backends.h"
#include "tests/simulation/rows.h"

namespace uplink::simulation {
namespace {

std::optional<model::Rejection> RefuseMarked(const storage::CommitRecord& record) {
  const auto* good = std::get_if<model::Record>(&record.content);
  if (good == nullptr) return std::nullopt;
  const auto* fault = std::get_if<model::Fault>(&good->body());
  if (fault == nullptr || fault->fault_id != kRefusedFaultId) return std::nullopt;
  return model::Rejection{model::RejectReason::kStoreRefused, "faultId", "refused on order"};
}

}  // namespace

storage::Store& FakeBackend::Reopen(const storage::ProcessId& process) {
  storage::StoreRules rules;
  rules.retain_quarantine = kQuarantineKept;
  store_ = std::make_unique<testing::FakeStore>(database_, process, rules);
  store_->SetRules({.refuse = RefuseMarked,
                    .allow_cursor_lowering = fault_ == Fault::kCursorMayFall,
                    .presence_without_cursor = fault_ == Fault::kNoCursorForPresence,
                    .batches_make_robots = fault_ == Fault::kBatchesMakeRobots});
  return *store_;
}

void FakeBackend::KeepCopy() {
  copy_.CopyRowsOf(database_);
  has_copy_ = true;
}

bool FakeBackend::GoBack() {
  if (!has_copy_) return false;
  database_.CopyRowsOf(copy_);
  store_->Break();
  return true;
}

std::optional<std::string> FakeBackend::Compare(const Recorder& recorder) {
  for (const auto& [key, durable] : recorder.sessions()) {
    const testing::SessionLog log = database_.Log(key.first, key.second);
    if (log.stored.size() != durable.stored.size() ||
        log.quarantined.size() != durable.quarantined.size()) {
      return fmt::format("session {} has {} rows and {} in quarantine, the book says {} and {}",
                         key.second.ToHex(), log.stored.size(), log.quarantined.size(),
                         durable.stored.size(), durable.quarantined.size());
    }
    for (const auto& [seq, times] : log.times_written) {
      if (times != 1) return fmt::format("number {} was written {} times", seq, times);
    }
  }
  for (const auto& [ruri, changes] : recorder.presence_history()) {
    const auto rows = AllRows<storage::PresenceRow>(
        ruri,
        [this](const storage::HistoryQuery& query) { return store_->PresenceChanges(query); });
    if (auto difference = ComparePresence(ruri, rows, changes)) return difference;
  }
  return std::nullopt;
}

}  // namespace uplink::simulation
