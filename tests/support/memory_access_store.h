#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "storage/access_store.h"

namespace uplink::testing {

/// What operators decide, in memory, with the rows of its audit in the open. For one thread.
class MemoryAccessStore final : public storage::AccessStore {
 public:
  absl::StatusOr<storage::AccessVersion> Version() override {
    if (!status.ok()) return status;
    return version_;
  }
  absl::StatusOr<std::vector<storage::Revocation>> RevocationsAfter(
      storage::AccessVersion after) override {
    if (!status.ok()) return status;
    return After(revocations_, after);
  }
  absl::StatusOr<std::vector<storage::RobotSetting>> SettingsAfter(
      storage::AccessVersion after) override {
    if (!status.ok()) return status;
    return After(settings_, after);
  }

  absl::StatusOr<bool> Revoke(const storage::Revocation& revocation,
                              const storage::AuditRow& row) override {
    if (!status.ok()) return status;
    audit.push_back(row);
    const auto found = std::ranges::find_if(revocations_, [&](const auto& each) {
      return each.by == revocation.by && each.value == revocation.value;
    });
    const bool was = found != revocations_.end() && found->revoked;
    if (was == revocation.revoked) return false;
    if (found != revocations_.end()) revocations_.erase(found);
    storage::Revocation next = revocation;
    next.at = row.at;
    next.who = row.who;
    next.version = ++version_;
    revocations_.push_back(std::move(next));
    return true;
  }
  absl::StatusOr<storage::RobotSetting> Change(const storage::SettingChange& change,
                                               const storage::AuditRow& row) override {
    if (!status.ok()) return status;
    audit.push_back(row);
    storage::RobotSetting setting;
    setting.ruri = change.ruri;
    const auto found = std::ranges::find(settings_, change.ruri, &storage::RobotSetting::ruri);
    if (found != settings_.end()) {
      setting = *found;
      settings_.erase(found);
    }
    if (change.blocked) {
      setting.blocked = *change.blocked;
      setting.blocked_why = change.blocked_why;
      setting.blocked_by = *change.blocked ? row.who : "";
      setting.blocked_at = row.at;
      if (!*change.blocked) setting.blocked_at.reset();
    }
    if (change.registered) setting.registered = *change.registered;
    for (const auto& [name, value] : change.labels) {
      if (value.empty()) {
        setting.labels.erase(name);
      } else {
        setting.labels[name] = value;
      }
    }
    if (change.note) setting.note = *change.note;
    if (change.disconnect) setting.disconnect_at = row.at;
    setting.version = ++version_;
    settings_.push_back(setting);
    return setting;
  }
  absl::Status Acknowledge(const storage::Acknowledgement& fault,
                           const storage::AuditRow& row) override {
    if (!status.ok()) return status;
    if (!active_faults.empty() && std::ranges::count(active_faults, fault.fault_id) == 0) {
      return absl::NotFoundError("no such fault is active");
    }
    audit.push_back(row);
    acknowledged.push_back(fault);
    return absl::OkStatus();
  }
  absl::Status Append(const storage::AuditRow& row) override {
    if (!status.ok()) return status;
    audit.push_back(row);
    return absl::OkStatus();
  }

  /// What all calls return, unless it is OK.
  absl::Status status;
  /// Ids of faults that are active; none: any is.
  std::vector<std::string> active_faults;
  std::vector<storage::Acknowledgement> acknowledged;
  std::vector<storage::AuditRow> audit;

 private:
  template <typename Row>
  static std::vector<Row> After(const std::vector<Row>& all, storage::AccessVersion after) {
    std::vector<Row> rows;
    for (const Row& row : all) {
      if (row.version > after && rows.size() < storage::kAccessPageMax) rows.push_back(row);
    }
    return rows;
  }

  storage::AccessVersion version_ = 0;
  /// In the order of their versions.
  std::vector<storage::Revocation> revocations_;
  std::vector<storage::RobotSetting> settings_;
};

}  // namespace uplink::testing
