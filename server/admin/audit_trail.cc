#include "server/admin/audit_trail.h"

#include <chrono>
#include <utility>

#include <fmt/core.h>

#include "server/admin/audit_rows.h"

namespace uplink::admin {

void AuditTrail::Tell(const storage::AuditRow& row) const {
  logger_.Info("audit", {{"who", row.who},
                         {"proof", ToText(row.proof)},
                         {"from", row.from},
                         {"action", row.action},
                         {"target", row.target},
                         {"fleet", row.fleet},
                         {"outcome", row.outcome},
                         {"detail", row.detail}});
}

void AuditTrail::Note(storage::AuditRow row) {
  Tell(row);
  const std::lock_guard lock(mutex_);
  if (waiting_.size() == kAuditWaitingMax) {
    waiting_.pop_front();
    ++lost_;
    // So that Flush takes away no row that it has not written.
    ++gone_;
  }
  waiting_.push_back(std::move(row));
}

void AuditTrail::NoteRefused(storage::AuditRow row) {
  {
    const std::lock_guard lock(mutex_);
    const auto since = row.at - minute_began_;
    // A clock that was set back begins a new one, too.
    if (since >= std::chrono::minutes(1) || since < SystemTime::duration(0)) {
      minute_began_ = row.at;
      refused_ = 0;
      refused_by_ = {};
    }
    if (refused_ == kRefusedPerMinuteMax || refused_by_.Of(row.who) == kRefusedOfCallerMax) {
      ++left_out_;
      return;
    }
    ++refused_;
    refused_by_.Add(row.who);
    if (const std::uint64_t left_out = std::exchange(left_out_, 0); left_out > 0) {
      row.detail = fmt::format("{} more before it. {}", left_out, row.detail);
    }
  }
  Note(std::move(row));
}

void AuditTrail::Flush(SharedStore& store) {
  for (;;) {
    storage::AuditRow row;
    std::uint64_t place = 0;
    {
      const std::lock_guard lock(mutex_);
      if (waiting_.empty()) break;
      row = waiting_.front();
      place = gone_;
    }
    const absl::Status written =
        store.With([&](storage::AccessStore& access) { return access.Append(row); });
    if (!written.ok()) return;
    const std::lock_guard lock(mutex_);
    if (gone_ != place) continue;
    waiting_.pop_front();
    ++gone_;
  }
  std::uint64_t lost = 0;
  {
    const std::lock_guard lock(mutex_);
    lost = std::exchange(lost_, 0);
  }
  if (lost > 0) logger_.Error("audit_rows_lost", {{"rows", lost}});
}

std::size_t AuditTrail::waiting() const {
  const std::lock_guard lock(mutex_);
  return waiting_.size();
}

}  // namespace uplink::admin
