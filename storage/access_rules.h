#pragma once

#include <map>
#include <string>
#include <string_view>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "storage/access_store.h"

// What every AccessStore decides alike. Pure; any thread.
namespace uplink::storage {

/// The row as stores take it: its texts are clean UTF-8 of at most kAuditTextBytesMax.
[[nodiscard]] AuditRow Bounded(AuditRow row);

// kInvalidArgument, naming the field, for what no store takes.
[[nodiscard]] absl::Status Check(const Revocation& revocation);
[[nodiscard]] absl::Status Check(const Acknowledgement& fault);

/// The setting after the change, with the version of `before`; equal to `before` if it changes
/// nothing. `before` without anything set: the store has none.
///
/// Errors: kInvalidArgument, naming the field; kResourceExhausted for more than kLabelsMax labels.
[[nodiscard]] absl::StatusOr<RobotSetting> Changed(RobotSetting before, const SettingChange& change,
                                                   const AuditRow& audit);

/// Everything was taken back but an earlier disconnect_at.
[[nodiscard]] bool SetsNothing(const RobotSetting& setting);

/// It says whether the robot may come in: the saved copy has it, and memory keeps it first.
[[nodiscard]] bool DecidesEntry(const RobotSetting& setting);

[[nodiscard]] absl::Status TooManyRevocations();
[[nodiscard]] absl::Status TooManySettings();
[[nodiscard]] absl::Status NoSuchFault(const Acknowledgement& fault);

/// What SettingIn reads, in order.
inline constexpr std::string_view kSettingColumns =
    "ruri, blocked, blocked_why, blocked_by, blocked_at, registered, labels, note, disconnect_at,"
    " version";

/// SetsNothing, as a condition on a row.
inline constexpr std::string_view kSetsNothingSql =
    "NOT blocked AND NOT registered AND labels = '{}' AND note = ''";
/// Something is set that goes with the robot when it is forgotten, as a condition on a row.
inline constexpr std::string_view kHasNotesSql = "(labels <> '{}' OR note <> '')";
/// What takes that back.
inline constexpr std::string_view kNoNotesSql = "labels = '{}', note = ''";

/// Labels as a column holds them.
[[nodiscard]] std::string LabelsText(const RobotSetting& setting);

/// Kind, value, whether it is revoked, when, who, reason, version. Row: as in read_row.h.
template <typename Row>
[[nodiscard]] Revocation RevocationIn(const Row& row) {
  return {.by = static_cast<RevokedBy>(row.Int(0)),
          .value = std::string(row.Bytes(1)),
          .revoked = row.Bool(2),
          .at = row.Time(3),
          .who = std::string(row.Bytes(4)),
          .reason = std::string(row.Bytes(5)),
          .version = static_cast<AccessVersion>(row.Int(6))};
}

/// The labels of a column.
[[nodiscard]] std::map<std::string, std::string> LabelsIn(std::string_view text);

/// The columns of kSettingColumns.
template <typename Row>
[[nodiscard]] RobotSetting SettingIn(const Row& row) {
  RobotSetting setting{.ruri = std::string(row.Bytes(0)),
                       .blocked = row.Bool(1),
                       .blocked_why = std::string(row.Bytes(2)),
                       .blocked_by = std::string(row.Bytes(3)),
                       .registered = row.Bool(5),
                       .labels = LabelsIn(row.Bytes(6)),
                       .note = std::string(row.Bytes(7)),
                       .version = static_cast<AccessVersion>(row.Int(9))};
  if (!row.Null(4)) setting.blocked_at = row.Time(4);
  if (!row.Null(8)) setting.disconnect_at = row.Time(8);
  return setting;
}

}  // namespace uplink::storage
