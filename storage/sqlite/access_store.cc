#include "storage/access_store.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/access_rules.h"
#include "storage/sqlite/access_sql.h"
#include "storage/sqlite/connections.h"
#include "storage/sqlite/parts.h"

namespace uplink::storage::sqlite {
namespace {

/// Without a time: NULL.
void BindTime(Statement& statement, int index, const std::optional<SystemTime>& time) {
  if (time) {
    statement.Bind(index, *time);
  } else {
    statement.Bind(index, Blob{});
  }
}

class SqliteAccessStore final : public AccessStore {
 public:
  explicit SqliteAccessStore(SideConnection side) : side_(std::move(side)) {}

  [[nodiscard]] absl::Status Prepare() {
    Preparer prepare(*side_.database);
    prepare.Into(version_, "SELECT version FROM access_version WHERE id = 0");
    prepare.Into(next_version_, kNextVersionSql);
    prepare.Into(revocations_,
                 "SELECT kind, value, revoked, at, who, reason, version FROM revocations"
                 " WHERE version > ? ORDER BY version LIMIT ?");
    const std::string settings =
        std::string("SELECT ").append(kSettingColumns) + " FROM robot_settings WHERE ";
    prepare.Into(settings_, settings + "version > ? ORDER BY version LIMIT ?");
    prepare.Into(setting_, settings + "ruri = ?");
    prepare.Into(is_revoked_, "SELECT revoked FROM revocations WHERE kind = ? AND value = ?");
    prepare.Into(count_revoked_, "SELECT count(*) FROM revocations WHERE revoked");
    prepare.Into(count_settings_, "SELECT count(*) FROM robot_settings");
    prepare.Into(set_revocation_,
                 "INSERT OR REPLACE INTO revocations"
                 " (kind, value, revoked, at, who, reason, version) VALUES (?, ?, ?, ?, ?, ?, ?)");
    prepare.Into(set_setting_,
                 "INSERT OR REPLACE INTO robot_settings"
                 " (ruri, blocked, blocked_why, blocked_by, blocked_at, registered, labels, note,"
                 " disconnect_at, changed_at, version) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
    prepare.Into(drop_revocations_, "DELETE FROM revocations WHERE NOT revoked AND at < ?");
    prepare.Into(drop_settings_,
                 "DELETE FROM robot_settings WHERE changed_at < ? AND NOT blocked"
                 " AND NOT registered AND labels = '{}' AND note = ''");
    prepare.Into(acknowledge_,
                 "UPDATE faults_active SET acknowledged_at = ?3, acknowledged_by = ?4,"
                 " acknowledged_note = ?5 WHERE ruri = ?1 AND fault_id = ?2 RETURNING 1");
    prepare.Into(audit_,
                 "INSERT INTO audit (at, proof, who, address, action, target, fleet, outcome,"
                 " detail) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)");
    return prepare.status();
  }

  absl::StatusOr<AccessVersion> Version() override {
    const absl::StatusOr<std::int64_t> version = version_->Select().OnlyInt();
    if (!version.ok()) return version.status();
    return static_cast<AccessVersion>(*version);
  }
  absl::StatusOr<std::vector<Revocation>> RevocationsAfter(AccessVersion after) override {
    return revocations_->Select(after, kAccessPageMax).All(RevocationIn<Rows>);
  }
  absl::StatusOr<std::vector<RobotSetting>> SettingsAfter(AccessVersion after) override {
    return settings_->Select(after, kAccessPageMax).All(SettingIn<Rows>);
  }

  absl::StatusOr<bool> Revoke(const Revocation& revocation, const AuditRow& audit) override {
    absl::Status bad = Check(revocation);
    if (!bad.ok()) return bad;
    // Robots' batches wait for each transaction that may write.
    const absl::StatusOr<bool> before = IsRevoked(revocation);
    if (!before.ok()) return before.status();
    if (*before == revocation.revoked) return false;
    return side_.database->InTransaction(
        [&]() -> absl::StatusOr<bool> { return RevokeNow(revocation, Bounded(audit)); });
  }
  absl::StatusOr<ChangedSetting> Change(const SettingChange& change,
                                        const AuditRow& audit) override {
    const AuditRow row = Bounded(audit);
    absl::StatusOr<Step> step = StepOf(change, row);
    if (!step.ok()) return step.status();
    if (!step->changes()) return ChangedSetting{.setting = std::move(step->after)};
    return side_.database->InTransaction(
        [&]() -> absl::StatusOr<ChangedSetting> { return ChangeNow(change, row); });
  }
  absl::Status Acknowledge(const Acknowledgement& fault, const AuditRow& audit) override {
    absl::Status bad = Check(fault);
    if (!bad.ok()) return bad;
    const AuditRow row = Bounded(audit);
    return side_.database
        ->InTransaction([&]() -> absl::StatusOr<std::size_t> {
          const absl::StatusOr<std::size_t> rows =
              acknowledge_->Select(fault.ruri, fault.fault_id, row.at, row.who, fault.note).Count();
          if (!rows.ok()) return rows.status();
          if (*rows == 0) return NoSuchFault(fault);
          absl::Status status = Note(row);
          if (!status.ok()) return status;
          return *rows;
        })
        .status();
  }
  absl::Status Append(const AuditRow& audit) override { return Note(Bounded(audit)); }

 private:
  absl::Status Note(const AuditRow& row) {
    return audit_->Run(row.at, static_cast<std::int64_t>(row.proof), row.who, row.from, row.action,
                       row.target, row.fleet, row.outcome, row.detail);
  }
  absl::StatusOr<AccessVersion> NextVersion() {
    const absl::StatusOr<std::int64_t> version = next_version_->Select().OnlyInt();
    if (!version.ok()) return version.status();
    return static_cast<AccessVersion>(*version);
  }

  absl::StatusOr<bool> IsRevoked(const Revocation& revocation) {
    const auto kind = static_cast<std::int64_t>(revocation.by);
    const auto found = is_revoked_->Select(kind, revocation.value).First([](const Rows& row) {
      return row.Bool(0);
    });
    if (!found.ok()) return found.status();
    return found->value_or(false);
  }
  absl::StatusOr<bool> RevokeNow(const Revocation& revocation, const AuditRow& audit) {
    const absl::StatusOr<bool> before = IsRevoked(revocation);
    if (!before.ok()) return before.status();
    if (*before == revocation.revoked) return false;
    absl::Status status = Note(audit);
    if (!status.ok()) return status;
    const auto kind = static_cast<std::int64_t>(revocation.by);
    if (revocation.revoked) {
      const absl::StatusOr<std::int64_t> count = count_revoked_->Select().OnlyInt();
      if (!count.ok()) return count.status();
      if (*count >= static_cast<std::int64_t>(kRevocationsMax)) return TooManyRevocations();
    }
    status = drop_revocations_->Run(audit.at - kTakenBackKept);
    if (!status.ok()) return status;
    const absl::StatusOr<AccessVersion> version = NextVersion();
    if (!version.ok()) return version.status();
    status = set_revocation_->Run(kind, revocation.value, std::int64_t{revocation.revoked},
                                  audit.at, audit.who, revocation.reason, *version);
    if (!status.ok()) return status;
    return true;
  }

  /// A change of what the store has now.
  struct Step {
    [[nodiscard]] bool changes() const { return after != before; }

    bool is_new = false;
    RobotSetting before;
    RobotSetting after;
  };
  absl::StatusOr<Step> StepOf(const SettingChange& change, const AuditRow& audit) {
    auto found = setting_->Select(change.ruri).First(SettingIn<Rows>);
    if (!found.ok()) return found.status();
    Step step{.is_new = !found->has_value(),
              .before = (*std::move(found)).value_or(RobotSetting{.ruri = change.ruri}),
              .after = {}};
    absl::StatusOr<RobotSetting> after = Changed(step.before, change, audit);
    if (!after.ok()) return after.status();
    step.after = *std::move(after);
    return step;
  }
  absl::StatusOr<ChangedSetting> ChangeNow(const SettingChange& change, const AuditRow& audit) {
    absl::StatusOr<Step> step = StepOf(change, audit);
    if (!step.ok()) return step.status();
    if (!step->changes()) return ChangedSetting{.setting = std::move(step->after)};
    absl::Status status = Note(audit);
    if (!status.ok()) return status;
    status = drop_settings_->Run(audit.at - kTakenBackKept);
    if (!status.ok()) return status;
    if (step->is_new) {
      const absl::StatusOr<std::int64_t> count = count_settings_->Select().OnlyInt();
      if (!count.ok()) return count.status();
      if (*count >= static_cast<std::int64_t>(kSettingsMax)) return TooManySettings();
    }
    const absl::StatusOr<AccessVersion> version = NextVersion();
    if (!version.ok()) return version.status();
    step->after.version = *version;
    status = Put(step->after, audit.at);
    if (!status.ok()) return status;
    return ChangedSetting{.setting = std::move(step->after), .changed = true};
  }
  absl::Status Put(const RobotSetting& setting, SystemTime at) {
    const std::string labels = LabelsText(setting);
    Statement& put = *set_setting_;
    int index = 0;
    put.Bind(++index, std::string_view(setting.ruri));
    put.Bind(++index, std::int64_t{setting.blocked});
    put.Bind(++index, std::string_view(setting.blocked_why));
    put.Bind(++index, std::string_view(setting.blocked_by));
    BindTime(put, ++index, setting.blocked_at);
    put.Bind(++index, std::int64_t{setting.registered});
    put.Bind(++index, std::string_view(labels));
    put.Bind(++index, std::string_view(setting.note));
    BindTime(put, ++index, setting.disconnect_at);
    put.Bind(++index, at);
    put.Bind(++index, setting.version);
    return put.Run();
  }

  SideConnection side_;
  std::unique_ptr<Statement> version_, next_version_, revocations_, settings_, setting_,
      is_revoked_, count_revoked_, count_settings_, set_revocation_, set_setting_,
      drop_revocations_, drop_settings_, acknowledge_, audit_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<AccessStore>> OpenAccessStore(const std::string& path,
                                                             DamagePtr damage) {
  return MakeOnSideConnection<SqliteAccessStore>(path, std::move(damage));
}

}  // namespace uplink::storage::sqlite
