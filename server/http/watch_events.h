#pragma once

#include <absl/status/status.h>

#include "server/http/message.h"
#include "server/identity/caller.h"
#include "server/view/watches.h"

namespace uplink::http {

/// The answer to who watches these robots: events named `robot`, `removed`, `snapshotEnd` and
/// `end`, each the JSON of a v1::RobotChange, the last an error.
[[nodiscard]] Response WatchResponse(view::Watches& watches, const identity::Caller& caller,
                                     view::WatchQuery query);

}  // namespace uplink::http
