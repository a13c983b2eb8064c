#include "server/admin/messages.h"

#include <cstddef>
#include <string>

#include "server/admin/audit_rows.h"
#include "server/view/timestamps.h"

namespace uplink::admin {

v1::RobotSetting ToMessage(const storage::RobotSetting& setting) {
  v1::RobotSetting message;
  message.set_ruri(setting.ruri);
  message.set_blocked(setting.blocked);
  message.set_blocked_why(setting.blocked_why);
  message.set_blocked_by(setting.blocked_by);
  view::SetTime(message, &v1::RobotSetting::mutable_blocked_at, setting.blocked_at);
  message.set_registered(setting.registered);
  message.mutable_labels()->insert(setting.labels.begin(), setting.labels.end());
  message.set_note(setting.note);
  return message;
}

v1::Revocation ToMessage(const storage::Revocation& revocation) {
  v1::Revocation message;
  switch (revocation.by) {
    case storage::RevokedBy::kIssuerSerial: {
      const std::size_t end = revocation.value.find(' ');
      message.set_serial(revocation.value.substr(0, end));
      if (end != std::string::npos) message.set_issuer(revocation.value.substr(end + 1));
      break;
    }
    case storage::RevokedBy::kCertificate:
      message.set_sha256(revocation.value);
      break;
    case storage::RevokedBy::kKey:
      message.set_key_sha256(revocation.value);
      break;
  }
  message.set_reason(revocation.reason);
  view::SetTime(message, &v1::Revocation::mutable_at, revocation.at);
  message.set_by(revocation.who);
  return message;
}

v1::AuditEntry ToMessage(const storage::AuditRow& row) {
  v1::AuditEntry message;
  view::SetTime(message, &v1::AuditEntry::mutable_at, row.at);
  message.set_proof(std::string(ToText(row.proof)));
  message.set_who(row.who);
  message.set_from(row.from);
  message.set_action(row.action);
  message.set_target(row.target);
  message.set_fleet(row.fleet);
  message.set_outcome(row.outcome);
  message.set_detail(row.detail);
  return message;
}

}  // namespace uplink::admin
