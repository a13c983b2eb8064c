#include "storage/access_store.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/access_rules.h"
#include "storage/postgres/access_sql.h"
#include "storage/postgres/own_connection.h"
#include "storage/postgres/parts.h"
#include "storage/sql_text.h"

namespace uplink::storage::postgres {
namespace {

constexpr std::string_view kVersion = "SELECT version FROM uplinkd.access_version WHERE id = 0";
/// Changes stand in line: what one of them reads stays true until it is committed.
constexpr std::string_view kLock =
    "SELECT version FROM uplinkd.access_version WHERE id = 0 FOR UPDATE";
constexpr std::string_view kRevocations =
    "SELECT kind, value, revoked, at, who, reason, version FROM uplinkd.revocations"
    " WHERE version > $1::bigint ORDER BY version LIMIT $2::bigint";
constexpr SqlText kSettings = {
    "SELECT ", kSettingColumns,
    " FROM uplinkd.robot_settings WHERE version > $1::bigint ORDER BY version LIMIT $2::bigint"};
constexpr SqlText kSetting = {"SELECT ", kSettingColumns,
                              " FROM uplinkd.robot_settings WHERE ruri = $1::text"};
constexpr std::string_view kIsRevoked =
    "SELECT EXISTS (SELECT 1 FROM uplinkd.revocations WHERE kind = $1::int AND value = $2::text"
    " AND revoked), (SELECT count(*) FROM uplinkd.revocations WHERE revoked)";
constexpr std::string_view kCountSettings = "SELECT count(*) FROM uplinkd.robot_settings";
constexpr std::string_view kSetRevocation =
    "INSERT INTO uplinkd.revocations (kind, value, revoked, at, who, reason, version)"
    " SELECT $1::int, $2::text, $3::int <> 0, $4::timestamptz, $5::text, $6::text, v.version"
    " FROM uplinkd.access_version AS v WHERE v.id = 0"
    " ON CONFLICT (kind, value) DO UPDATE SET revoked = excluded.revoked, at = excluded.at,"
    " who = excluded.who, reason = excluded.reason, version = excluded.version";
constexpr std::string_view kSetSetting =
    "INSERT INTO uplinkd.robot_settings (ruri, blocked, blocked_why, blocked_by, blocked_at,"
    " registered, labels, note, disconnect_at, changed_at, version)"
    " SELECT $1::text, $2::int <> 0, $3::text, $4::text, $5::timestamptz, $6::int <> 0, $7::text,"
    " $8::text, $9::timestamptz, $10::timestamptz, v.version"
    " FROM uplinkd.access_version AS v WHERE v.id = 0"
    " ON CONFLICT (ruri) DO UPDATE SET blocked = excluded.blocked,"
    " blocked_why = excluded.blocked_why, blocked_by = excluded.blocked_by,"
    " blocked_at = excluded.blocked_at, registered = excluded.registered,"
    " labels = excluded.labels, note = excluded.note, disconnect_at = excluded.disconnect_at,"
    " changed_at = excluded.changed_at, version = excluded.version";
constexpr std::string_view kDropRevocations =
    "DELETE FROM uplinkd.revocations WHERE NOT revoked AND version <= (SELECT version"
    " FROM uplinkd.revocations WHERE NOT revoked ORDER BY version DESC LIMIT 1 OFFSET $1::bigint)";
constexpr SqlText kDropSettings = {
    "DELETE FROM uplinkd.robot_settings WHERE ", kSetsNothingSql,
    " AND version <= (SELECT version FROM uplinkd.robot_settings WHERE ", kSetsNothingSql,
    " ORDER BY version DESC LIMIT 1 OFFSET $1::bigint)"};
/// As a batch of the robot does before it writes its rows, so that the two wait in one order.
constexpr std::string_view kLockRobot =
    "SELECT 1 FROM uplinkd.robots WHERE ruri = $1::text FOR NO KEY UPDATE";
constexpr std::string_view kAcknowledge =
    "UPDATE uplinkd.faults_active SET acknowledged_at = $3::timestamptz,"
    " acknowledged_by = $4::text, acknowledged_note = $5::text"
    " WHERE ruri = $1::text AND fault_id = $2::text";
constexpr std::string_view kAudit =
    "INSERT INTO uplinkd.audit (at, entry, proof, who, address, action, target, fleet, outcome,"
    " detail) VALUES ($1::timestamptz, nextval('uplinkd.batches') << 20, $2::int, $3::text,"
    " $4::text, $5::text, $6::text, $7::text, $8::text, $9::text)";
constexpr std::string_view kNotify = "NOTIFY uplinkd_access";

StoreCall AuditCall(const AuditRow& row) {
  return StoreCallOf(kAudit, row.at, static_cast<std::int32_t>(row.proof), row.who, row.from,
                     row.action, row.target, row.fleet, row.outcome, row.detail);
}

void AddTime(StoreCall& call, const std::optional<SystemTime>& time) {
  if (time) {
    call.parameters.Add(*time);
  } else {
    call.parameters.Add(std::nullopt);
  }
}

StoreCall SettingCall(const RobotSetting& setting, SystemTime at) {
  StoreCall call = StoreCallOf(kSetSetting, setting.ruri, setting.blocked ? 1 : 0,
                               setting.blocked_why, setting.blocked_by);
  AddTime(call, setting.blocked_at);
  call.parameters.Add(setting.registered ? 1 : 0);
  call.parameters.Add(LabelsText(setting));
  call.parameters.Add(setting.note);
  AddTime(call, setting.disconnect_at);
  call.parameters.Add(at);
  return call;
}

class PostgresAccessStore final : public AccessStore {
 public:
  explicit PostgresAccessStore(std::unique_ptr<OwnConnection> connection)
      : connection_(std::move(connection)) {}

  absl::StatusOr<AccessVersion> Version() override {
    const auto row =
        connection_->ReadSoon(StoreCallOf(kVersion), "read the version of access", kAccessLookMax);
    if (!row.ok()) return row.status();
    return row->rows() == 0 ? 0 : static_cast<AccessVersion>(row->Int(0, 0));
  }
  absl::StatusOr<std::vector<Revocation>> RevocationsAfter(AccessVersion after) override {
    const auto rows = connection_->ReadAgain(StoreCallOf(kRevocations, after, kAccessPageMax),
                                             "read revocations");
    if (!rows.ok()) return rows.status();
    return rows->All(RevocationIn<ResultRow>);
  }
  absl::StatusOr<std::vector<RobotSetting>> SettingsAfter(AccessVersion after) override {
    const auto rows = connection_->ReadAgain(StoreCallOf(kSettings.view(), after, kAccessPageMax),
                                             "read settings of robots");
    if (!rows.ok()) return rows.status();
    return rows->All(SettingIn<ResultRow>);
  }

  absl::StatusOr<bool> Revoke(const Revocation& revocation, const AuditRow& audit) override {
    absl::Status bad = Check(revocation);
    if (!bad.ok()) return bad;
    const AuditRow row = Bounded(audit);
    const auto kind = static_cast<std::int32_t>(revocation.by);
    bool changes = false;
    const auto written = connection_->ReadAndWrite(
        PipelineOf(StoreCallOf(kLock), StoreCallOf(kIsRevoked, kind, revocation.value)),
        [&](const std::vector<Result>& read) -> absl::StatusOr<std::vector<StoreCall>> {
          changes = read[1].Bool(0, 0) != revocation.revoked;
          // The commit still says that what made it so is durable.
          if (!changes) return std::vector<StoreCall>();
          std::vector<StoreCall> calls = PipelineOf(AuditCall(row));
          const std::int64_t count = read[1].Int(0, 1);
          if (revocation.revoked && count >= static_cast<std::int64_t>(kRevocationsMax)) {
            return TooManyRevocations();
          }
          calls.push_back(StoreCallOf(kNextVersionSql.view()));
          calls.push_back(StoreCallOf(kDropRevocations, kTakenBackKept));
          calls.push_back(StoreCallOf(kSetRevocation, kind, revocation.value,
                                      revocation.revoked ? 1 : 0, row.at, row.who,
                                      revocation.reason));
          calls.push_back(StoreCallOf(kNotify));
          return calls;
        },
        "revoke a certificate", kAccessLookMax);
    if (!written.ok()) return written.status();
    return changes;
  }

  absl::StatusOr<ChangedSetting> Change(const SettingChange& change,
                                        const AuditRow& audit) override {
    const AuditRow row = Bounded(audit);
    RobotSetting after;
    bool changes = false;
    const auto written = connection_->ReadAndWrite(
        PipelineOf(StoreCallOf(kLock), StoreCallOf(kSetting.view(), change.ruri),
                   StoreCallOf(kCountSettings)),
        [&](const std::vector<Result>& read) -> absl::StatusOr<std::vector<StoreCall>> {
          RobotSetting before;
          before.ruri = change.ruri;
          const bool found = read[1].rows() > 0;
          if (found) before = SettingIn(*read[1].begin());
          absl::StatusOr<RobotSetting> changed = Changed(before, change, row);
          if (!changed.ok()) return changed.status();
          after = *std::move(changed);
          changes = after != before;
          if (!changes) return std::vector<StoreCall>();
          std::vector<StoreCall> calls = PipelineOf(AuditCall(row));
          if (!found && read[2].Int(0, 0) >= static_cast<std::int64_t>(kSettingsMax)) {
            return TooManySettings();
          }
          calls.push_back(StoreCallOf(kNextVersionSql.view()));
          calls.push_back(StoreCallOf(kDropSettings.view(), kTakenBackKept));
          calls.push_back(SettingCall(after, row.at));
          calls.push_back(StoreCallOf(kNotify));
          return calls;
        },
        "change a robot's setting", kAccessLookMax);
    if (!written.ok()) return written.status();
    if (changes) after.version = static_cast<AccessVersion>((*written)[1].Int(0, 0));
    return ChangedSetting{.setting = std::move(after), .changed = changes};
  }

  absl::Status Acknowledge(const Acknowledgement& fault, const AuditRow& audit) override {
    absl::Status bad = Check(fault);
    if (!bad.ok()) return bad;
    const AuditRow row = Bounded(audit);
    return connection_
        ->ReadAndWrite(
            PipelineOf(
                StoreCallOf(kLockRobot, fault.ruri),
                StoreCallOf(kAcknowledge, fault.ruri, fault.fault_id, row.at, row.who, fault.note)),
            [&](const std::vector<Result>& done) -> absl::StatusOr<std::vector<StoreCall>> {
              if (done[1].written() == 0) return NoSuchFault(fault);
              return PipelineOf(AuditCall(row));
            },
            "acknowledge a fault", kAccessLookMax)
        .status();
  }
  absl::Status Append(const AuditRow& audit) override {
    return connection_->Write(AuditCall(Bounded(audit)), "write the audit").status();
  }

 private:
  const std::unique_ptr<OwnConnection> connection_;
};

}  // namespace

StoreOptions FollowingAccess(StoreOptions options) {
  options.connect_timeout = std::min(options.connect_timeout, kAccessConnectMax);
  options.call_timeout = std::min(options.call_timeout, kAccessReadMax);
  return options;
}

absl::StatusOr<std::unique_ptr<AccessStore>> MakeAccessStore(const StoreOptions& options,
                                                             const Clock& clock) {
  return MakeOverOwn<PostgresAccessStore>(options, clock);
}

}  // namespace uplink::storage::postgres
