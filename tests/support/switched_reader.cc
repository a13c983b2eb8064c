#include "tests/support/switched_reader.h"

#include <algorithm>
#include <utility>

namespace uplink::testing {

absl::Status SwitchedReader::Enter() {
  std::unique_lock lock(mutex_);
  ++calls_;
  ++inside_;
  changed_.notify_all();
  changed_.wait(lock, [this] { return !held_; });
  --inside_;
  return fails_;
}

void SwitchedReader::SetAway(bool away) {
  Fail(away ? absl::UnavailableError("the test took the store away") : absl::OkStatus());
}

void SwitchedReader::Fail(absl::Status status) {
  const std::lock_guard lock(mutex_);
  fails_ = std::move(status);
}

void SwitchedReader::SetLatestMax(std::size_t robots) {
  const std::lock_guard lock(mutex_);
  latest_max_ = robots;
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

absl::StatusOr<std::size_t> SwitchedReader::RobotCount() {
  if (absl::Status here = Enter(); !here.ok()) return here;
  return reader_.RobotCount();
}

absl::StatusOr<std::vector<std::string>> SwitchedReader::FleetsBeyondAscii(
    std::uint32_t fleets_max) {
  if (absl::Status here = Enter(); !here.ok()) return here;
  return reader_.FleetsBeyondAscii(fleets_max);
}

absl::StatusOr<std::vector<storage::DroppedRow>> SwitchedReader::QuarantineDropped(
    const std::string& ruri) {
  if (absl::Status here = Enter(); !here.ok()) return here;
  return reader_.QuarantineDropped(ruri);
}

absl::StatusOr<std::vector<storage::StoredReject>> SwitchedReader::Rejects(
    const storage::RejectsQuery& query) {
  if (absl::Status here = Enter(); !here.ok()) return here;
  return reader_.Rejects(query);
}

absl::StatusOr<std::vector<storage::ActiveFaults>> SwitchedReader::ActiveFaultCounts(
    std::span<const std::string> ruris) {
  if (absl::Status here = Enter(); !here.ok()) return here;
  return reader_.ActiveFaultCounts(ruris);
}

absl::StatusOr<std::vector<storage::OpenRequestCount>> SwitchedReader::OpenRequestCounts(
    std::span<const std::string> ruris) {
  if (absl::Status here = Enter(); !here.ok()) return here;
  return reader_.OpenRequestCounts(ruris);
}

absl::StatusOr<storage::Reader::LatestRows> SwitchedReader::Latest(
    std::span<const std::string> ruris, storage::LatestKindSet kinds) {
  if (absl::Status here = Enter(); !here.ok()) return here;
  std::size_t looked_at = ruris.size();
  {
    const std::lock_guard lock(mutex_);
    looked_at = std::min(looked_at, latest_max_);
  }
  return reader_.Latest(ruris.first(looked_at), kinds);
}

absl::StatusOr<storage::Reader::LiveRows> SwitchedReader::LiveOf(
    std::span<const std::string> ruris) {
  if (absl::Status here = Enter(); !here.ok()) return here;
  return reader_.LiveOf(ruris);
}

// NOLINTBEGIN(bugprone-macro-parentheses): the arguments are names of types and functions
#define UPLINK_LIST(Name, number, Row, Query, retained)                                           \
  absl::StatusOr<storage::Page<storage::Row>> SwitchedReader::Name(const storage::Query& query) { \
    if (absl::Status here = Enter(); !here.ok()) return here;                                     \
    return reader_.Name(query);                                                                   \
  }
UPLINK_LISTS(UPLINK_LIST)
#undef UPLINK_LIST
// NOLINTEND(bugprone-macro-parentheses)

absl::StatusOr<storage::Page<storage::AuditRow>> SwitchedReader::Audit(
    const storage::AuditQuery& query) {
  if (absl::Status here = Enter(); !here.ok()) return here;
  return reader_.Audit(query);
}

}  // namespace uplink::testing
