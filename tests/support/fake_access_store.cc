#include "tests/support/fake_access_store.h"

#include <algorithm>
#include <mutex>
#include <utility>

#include "storage/access_rules.h"

namespace uplink::testing {
namespace {

/// The rows whose version is above `after`, ascending, at most a page.
template <typename Rows>
auto After(const Rows& rows, storage::AccessVersion after) {
  std::vector<typename Rows::mapped_type> newer;
  for (const auto& [key, row] : rows) {
    if (row.version > after) newer.push_back(row);
  }
  std::ranges::sort(newer, {}, [](const auto& row) { return row.version; });
  if (newer.size() > storage::kAccessPageMax) newer.resize(storage::kAccessPageMax);
  return newer;
}

}  // namespace

absl::StatusOr<storage::AccessVersion> FakeAccessStore::Version() {
  if (!status.ok()) return status;
  const std::lock_guard lock(database_.mutex_);
  return database_.access_.version;
}

absl::StatusOr<std::vector<storage::Revocation>> FakeAccessStore::RevocationsAfter(
    storage::AccessVersion after) {
  if (!status.ok()) return status;
  const std::lock_guard lock(database_.mutex_);
  return After(database_.access_.revocations, after);
}

absl::StatusOr<std::vector<storage::RobotSetting>> FakeAccessStore::SettingsAfter(
    storage::AccessVersion after) {
  if (!status.ok()) return status;
  const std::lock_guard lock(database_.mutex_);
  return After(database_.access_.settings, after);
}

absl::StatusOr<bool> FakeAccessStore::Revoke(const storage::Revocation& revocation,
                                             const storage::AuditRow& audit) {
  if (!status.ok()) return status;
  absl::Status bad = storage::Check(revocation);
  if (!bad.ok()) return bad;
  const std::lock_guard lock(database_.mutex_);
  FakeAccess& access = database_.access_;
  const std::pair key(revocation.by, revocation.value);
  const auto found = access.revocations.find(key);
  const bool before = found != access.revocations.end() && found->second.revoked;
  if (revocation.revoked && !before) {
    const auto revoked = static_cast<std::size_t>(std::ranges::count_if(
        access.revocations, [](const auto& one) { return one.second.revoked; }));
    if (revoked >= storage::kRevocationsMax) return storage::TooManyRevocations();
  }
  if (before == revocation.revoked) return false;
  Note(audit);
  std::erase_if(access.revocations, [&audit](const auto& one) {
    return !one.second.revoked && one.second.at < audit.at - storage::kTakenBackKept;
  });
  storage::Revocation row = revocation;
  row.at = audit.at;
  row.who = storage::Bounded(audit).who;
  row.version = ++access.version;
  access.revocations.insert_or_assign(key, std::move(row));
  return true;
}

absl::StatusOr<storage::ChangedSetting> FakeAccessStore::Change(
    const storage::SettingChange& change, const storage::AuditRow& audit) {
  if (!status.ok()) return status;
  const std::lock_guard lock(database_.mutex_);
  FakeAccess& access = database_.access_;
  const auto found = access.settings.find(change.ruri);
  storage::RobotSetting before;
  before.ruri = change.ruri;
  if (found != access.settings.end()) before = found->second;
  absl::StatusOr<storage::RobotSetting> after = storage::Changed(before, change, audit);
  if (!after.ok()) return after.status();
  if (*after == before) return storage::ChangedSetting{.setting = *std::move(after)};
  const bool is_new = found == access.settings.end();
  if (is_new && access.settings.size() >= storage::kSettingsMax) return storage::TooManySettings();
  Note(audit);
  std::erase_if(access.settings, [&access, &audit](const auto& one) {
    return storage::SetsNothing(one.second) &&
           access.changed_at[one.first] < audit.at - storage::kTakenBackKept;
  });
  access.changed_at[change.ruri] = audit.at;
  after->version = ++access.version;
  access.settings.insert_or_assign(change.ruri, *after);
  return storage::ChangedSetting{.setting = *std::move(after), .changed = true};
}

absl::Status FakeAccessStore::Acknowledge(const storage::Acknowledgement& fault,
                                          const storage::AuditRow& audit) {
  if (!status.ok()) return status;
  absl::Status bad = storage::Check(fault);
  if (!bad.ok()) return bad;
  const std::lock_guard lock(database_.mutex_);
  const auto robot = database_.robots_.find(fault.ruri);
  if (robot == database_.robots_.end()) return storage::NoSuchFault(fault);
  bool found = false;
  for (auto& [key, active] : robot->second.faults_active) {
    if (key.first != fault.fault_id) continue;
    active.row.acknowledged_at = audit.at;
    active.row.acknowledged_by = storage::Bounded(audit).who;
    active.row.acknowledged_note = fault.note;
    found = true;
  }
  if (!found) return storage::NoSuchFault(fault);
  Note(audit);
  return absl::OkStatus();
}

absl::Status FakeAccessStore::Append(const storage::AuditRow& audit) {
  if (!status.ok()) return status;
  const std::lock_guard lock(database_.mutex_);
  Note(audit);
  return absl::OkStatus();
}

void FakeAccessStore::Note(const storage::AuditRow& audit) {
  database_.access_.audit.push_back({audit.at, ++database_.entries_, storage::Bounded(audit)});
}

}  // namespace uplink::testing
