#pragma once

#include <cstdint>
#include <string>

#include "server/config/config.h"
#include "tools/uplinkctl/doctor/finding.h"
#include "tools/uplinkctl/doctor/sqlite_facts.h"

namespace uplink::ctl {

/// Whether a server could use the file: rights of `user`, names, damage, schema (this program's is
/// `schema_needed`). A pure function.
[[nodiscard]] Findings SqliteFindings(const SqliteFacts& facts, const config::StoreConfig& store,
                                      std::int64_t schema_needed, const std::string& user);

}  // namespace uplink::ctl
