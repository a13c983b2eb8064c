#pragma once

#include <string_view>

#include "storage/access_rules.h"
#include "storage/sql_text.h"

namespace uplink::storage::postgres {

/// The database's clock in milliseconds, and always more than before; `t` is the row that is there.
inline constexpr std::string_view kRaiseVersion =
    " ON CONFLICT (id) DO UPDATE SET version = greatest(t.version + 1, excluded.version)"
    " RETURNING version";
inline constexpr std::string_view kVersionNow =
    "INSERT INTO uplinkd.access_version AS t (id, version)"
    " SELECT 0, floor(extract(epoch FROM clock_timestamp()) * 1000)::bigint";

/// Draws the next AccessVersion, in the transaction of what it is of.
inline constexpr SqlText kNextVersionSql = {kVersionNow, kRaiseVersion};

/// Labels and note go with the robot, once its row is gone. A block and a registration stay: they
/// are of its name.
inline constexpr SqlText kDropNotesSql = {
    "WITH v AS (",
    kVersionNow,
    " WHERE EXISTS (SELECT 1 FROM uplinkd.robot_settings AS s WHERE s.ruri = $1::text AND ",
    kHasNotesSql,
    ") AND NOT EXISTS (SELECT 1 FROM uplinkd.robots AS r WHERE r.ruri = $1::text)",
    kRaiseVersion,
    ") UPDATE uplinkd.robot_settings AS t SET ",
    kNoNotesSql,
    ", changed_at = now(), version = v.version FROM v WHERE t.ruri = $1::text"};

}  // namespace uplink::storage::postgres
