#pragma once

#include <string_view>

namespace uplink::storage::sqlite {

/// Draws the next AccessVersion, in the transaction of what it is of: by the machine's clock in
/// milliseconds, and always more than before.
inline constexpr std::string_view kNextVersionSql =
    "UPDATE access_version SET version = max(version + 1,"
    " CAST((julianday('now') - 2440587.5) * 86400000 AS INTEGER)) WHERE id = 0 RETURNING version";

}  // namespace uplink::storage::sqlite
