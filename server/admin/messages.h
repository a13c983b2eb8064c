#pragma once

#include "storage/access_store.h"
#include "storage/audit.h"
#include "uplink/v1/admin.pb.h"

// What the store keeps as messages of admin.proto. Pure.
namespace uplink::admin {

[[nodiscard]] v1::RobotSetting ToMessage(const storage::RobotSetting& setting);
[[nodiscard]] v1::Revocation ToMessage(const storage::Revocation& revocation);
[[nodiscard]] v1::AuditEntry ToMessage(const storage::AuditRow& row);

}  // namespace uplink::admin
