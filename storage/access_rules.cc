#include "storage/access_rules.h"

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <utility>

#include "schema/base/utf8.h"
#include "schema/json/text.h"
#include "schema/model/ids.h"

namespace uplink::storage {
namespace {

/// kInvalidArgument unless the text is clean and has at most so many bytes.
absl::Status CheckText(std::string_view field, std::string_view text, std::size_t bytes_max) {
  if (text.size() > bytes_max) {
    return absl::InvalidArgumentError(std::string(field) + ": longer than " +
                                      std::to_string(bytes_max) + " bytes");
  }
  if (!IsCleanUtf8(text)) return absl::InvalidArgumentError(std::string(field) + ": no UTF-8");
  return absl::OkStatus();
}

absl::Status CheckName(std::string_view field, std::string_view text, std::size_t bytes_max) {
  if (text.empty()) return absl::InvalidArgumentError(std::string(field) + ": empty");
  return CheckText(field, text, bytes_max);
}

absl::Status CheckLabels(const std::map<std::string, std::string>& labels) {
  for (const auto& [name, value] : labels) {
    absl::Status status = CheckName("labels", name, kLabelBytesMax);
    if (status.ok()) status = CheckText("labels", value, kLabelBytesMax);
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status Check(const SettingChange& change) {
  absl::Status status = CheckName("ruri", change.ruri, model::kRuriBytesMax);
  if (status.ok()) status = CheckText("reason", change.blocked_why, kReasonBytesMax);
  if (status.ok() && change.note) status = CheckText("note", *change.note, kNoteBytesMax);
  return status.ok() ? CheckLabels(change.labels) : status;
}

void SetBlocked(RobotSetting& setting, const SettingChange& change, const AuditRow& audit) {
  if (!*change.blocked) {
    setting.blocked = false;
    setting.blocked_why.clear();
    setting.blocked_by.clear();
    setting.blocked_at.reset();
    return;
  }
  if (setting.blocked) {
    // Who blocked it, and since when, stays the answer to why it cannot connect.
    if (!change.blocked_why.empty()) setting.blocked_why = change.blocked_why;
    return;
  }
  setting.blocked = true;
  setting.blocked_why = change.blocked_why;
  setting.blocked_by = Bounded(audit).who;
  setting.blocked_at = audit.at;
}

}  // namespace

AuditRow Bounded(AuditRow row) {
  for (std::string* const text :
       {&row.who, &row.from, &row.action, &row.target, &row.fleet, &row.outcome, &row.detail}) {
    *text = PrintableUtf8(*text, kAuditTextBytesMax);
  }
  return row;
}

absl::Status Check(const Revocation& revocation) {
  absl::Status status = CheckName("certificate", revocation.value, kRevokedValueBytesMax);
  return status.ok() ? CheckText("reason", revocation.reason, kReasonBytesMax) : status;
}

absl::Status Check(const Acknowledgement& fault) {
  absl::Status status = CheckName("ruri", fault.ruri, model::kRuriBytesMax);
  if (status.ok() && !IsCleanUtf8(fault.fault_id)) {
    status = absl::InvalidArgumentError("faultId: no UTF-8");
  }
  return status.ok() ? CheckText("note", fault.note, kNoteBytesMax) : status;
}

absl::StatusOr<RobotSetting> Changed(RobotSetting before, const SettingChange& change,
                                     const AuditRow& audit) {
  absl::Status status = Check(change);
  if (!status.ok()) return status;
  RobotSetting after = std::move(before);
  after.ruri = change.ruri;
  if (change.blocked) SetBlocked(after, change, audit);
  if (change.registered) after.registered = *change.registered;
  if (change.note) after.note = *change.note;
  for (const auto& [name, value] : change.labels) {
    if (value.empty()) {
      after.labels.erase(name);
    } else {
      after.labels.insert_or_assign(name, value);
    }
  }
  if (after.labels.size() > kLabelsMax) {
    return absl::ResourceExhaustedError("labels: more than " + std::to_string(kLabelsMax));
  }
  if (change.disconnect) {
    // Two at one time are two.
    const SystemTime last = after.disconnect_at.value_or(audit.at - milliseconds(1));
    after.disconnect_at = std::max(audit.at, last + milliseconds(1));
  }
  return after;
}

bool SetsNothing(const RobotSetting& setting) {
  return !DecidesEntry(setting) && setting.labels.empty() && setting.note.empty();
}

bool DecidesEntry(const RobotSetting& setting) { return setting.blocked || setting.registered; }

absl::Status TooManyRevocations() {
  return absl::ResourceExhaustedError(std::to_string(kRevocationsMax) +
                                      " certificates and keys are revoked already");
}

absl::Status TooManySettings() {
  return absl::ResourceExhaustedError("operators set something of " + std::to_string(kSettingsMax) +
                                      " robots already");
}

absl::Status NoSuchFault(const Acknowledgement& fault) {
  return absl::NotFoundError("no such fault is active: " +
                             PrintableUtf8(fault.fault_id, kAuditTextBytesMax));
}

std::string LabelsText(const RobotSetting& setting) { return json::TextsText(setting.labels); }

std::map<std::string, std::string> LabelsIn(std::string_view text) { return json::TextsIn(text); }

}  // namespace uplink::storage
