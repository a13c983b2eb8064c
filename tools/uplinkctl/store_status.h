#pragma once

#include "storage/postgres/admin.h"

namespace uplink::ctl {

/// `uplinkctl store status`: what the store is and whether this program may use it; of an SQLite
/// file also its size and whether a server has it. The exit code: 1 if steps of the schema are
/// missing in PostgreSQL, or no server could use the store.
///
/// An SQLite file is only looked at: nothing is opened that a running server may hold.
[[nodiscard]] int StoreStatus(const storage::postgres::AdminOptions& target);

}  // namespace uplink::ctl
