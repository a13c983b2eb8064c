#pragma once

#include <array>
#include <string_view>

namespace uplink::storage {

/// Tables of both stores whose rows something that goes by civil time deletes: age, expiry, or a
/// robot that is forgotten. Where all of them are empty there is nothing to lose.
inline constexpr auto kKeptTables = std::to_array<std::string_view>(
    {"robots", "sessions", "faults_history", "events", "messages", "mission_reports",
     "presence_changes", "quarantine", "faults_active", "mission_runs", "shapes", "objects",
     "latest", "presence_latest", "gaps", "live"});

}  // namespace uplink::storage
