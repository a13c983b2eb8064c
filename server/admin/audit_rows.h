#pragma once

#include <string>
#include <string_view>

#include <absl/status/status.h>

#include "schema/base/clock.h"
#include "server/admin/asker.h"
#include "storage/audit.h"

namespace uplink::admin {

/// What was done, or asked for. A value.
struct Deed {
  /// A word of kActions.
  std::string_view action;
  /// What it was about; empty: the server.
  std::string target{};
  /// The fleet that the target has; empty: it belongs to none.
  std::string fleet{};
  std::string detail{};
};

/// The row of a deed and what came of it. Its texts are printable and cut at kAuditTextBytesMax,
/// since clients wrote some of them. Pure.
[[nodiscard]] storage::AuditRow RowOf(const Asker& asker, const Deed& deed,
                                      const absl::Status& outcome, SystemTime at);
/// The row of what the server did itself. `server` names it. Pure.
[[nodiscard]] storage::AuditRow RowOfServer(std::string_view server, const Deed& deed,
                                            SystemTime at);

/// As AuditEntry.proof.
[[nodiscard]] std::string_view ToText(storage::AuditProof proof);

}  // namespace uplink::admin
