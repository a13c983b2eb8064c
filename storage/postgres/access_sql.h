#pragma once

#include <string_view>

namespace uplink::storage::postgres {

/// Draws the next AccessVersion, in the transaction of what it is of: by the database's clock in
/// milliseconds, and always more than before.
inline constexpr std::string_view kNextVersionSql =
    "UPDATE uplinkd.access_version SET version = greatest(version + 1,"
    " floor(extract(epoch FROM clock_timestamp()) * 1000)::bigint) WHERE id = 0 RETURNING version";

/// Labels and note go with the robot, once its row is gone. A block and a registration stay: they
/// are of its name.
inline constexpr std::string_view kDropNotesSql =
    "WITH v AS (UPDATE uplinkd.access_version SET version = greatest(version + 1,"
    " floor(extract(epoch FROM clock_timestamp()) * 1000)::bigint) WHERE id = 0"
    " AND EXISTS (SELECT 1 FROM uplinkd.robot_settings AS s WHERE s.ruri = $1::text"
    " AND (s.labels <> '{}' OR s.note <> ''))"
    " AND NOT EXISTS (SELECT 1 FROM uplinkd.robots AS r WHERE r.ruri = $1::text)"
    " RETURNING version)"
    " UPDATE uplinkd.robot_settings AS t SET labels = '{}', note = '', changed_at = now(),"
    " version = v.version FROM v WHERE t.ruri = $1::text";

}  // namespace uplink::storage::postgres
