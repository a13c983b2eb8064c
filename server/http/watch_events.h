#pragma once

#include <string>

#include "server/http/message.h"
#include "server/identity/caller.h"
#include "server/view/watches.h"

namespace uplink::http {

/// The answer to who watches these robots: events named `robot`, `removed`, `snapshotEnd` and
/// `end`, each the JSON of a v1::RobotChange, the last an error.
[[nodiscard]] Response WatchResponse(view::Watches& watches, view::WatchQuery query);
/// What WatchQuery::caller says of a caller. Those without a proof are all the same one.
[[nodiscard]] std::string WatcherOf(const identity::Caller& caller);

}  // namespace uplink::http
