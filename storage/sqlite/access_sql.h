#pragma once

#include <string_view>

namespace uplink::storage::sqlite {

/// Draws the next AccessVersion, in the transaction of what it is of: by the machine's clock in
/// milliseconds, and always more than before.
inline constexpr std::string_view kNextVersionSql =
    "INSERT INTO access_version AS t (id, version)"
    " VALUES (0, CAST((julianday('now') - 2440587.5) * 86400000 AS INTEGER))"
    " ON CONFLICT (id) DO UPDATE SET version = max(t.version + 1, excluded.version)"
    " RETURNING version";

}  // namespace uplink::storage::sqlite
