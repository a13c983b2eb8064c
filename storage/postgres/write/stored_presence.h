#pragma once

#include <functional>
#include <span>
#include <string_view>

#include "storage/postgres/link/connection.h"
#include "storage/presence.h"

namespace uplink::storage::postgres {

/// Reads the last presence of each of `ruris` that the store has. A statement that follows the one
/// which locks the robots' rows: what a former holder committed before is seen.
[[nodiscard]] StoreCall ReadPresenceCall(std::span<const std::string_view> ruris);
/// Tells `take` each robot and its presence in an answer to that.
void TakePresence(const Result& rows,
                  const std::function<void(std::string_view ruri, StoredPresence)>& take);

}  // namespace uplink::storage::postgres
