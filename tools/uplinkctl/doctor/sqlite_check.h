#pragma once

#include <cstdint>
#include <string>

#include "server/config/config.h"
#include "tools/uplinkctl/doctor/finding.h"
#include "tools/uplinkctl/doctor/sqlite_facts.h"

namespace uplink::ctl {

/// Whether a server could use the file: its kind, rights of `user`, names, damage, schema (this
/// program's is `schema_needed`). A pure function.
[[nodiscard]] Findings SqliteFindings(const SqliteFacts& facts, const config::StoreConfig& store,
                                      std::int64_t schema_needed, const std::string& user);

/// Who holds a store that is held. Closed.
enum class StoreHolder : std::uint8_t {
  /// The running server of this configuration.
  kOwnServer,
  kOther,
  /// The configuration fixes no port by which its server could be known.
  kUnknown,
};

/// Whether a server that is started now gets the store, which one process at a time has. A pure
/// function.
[[nodiscard]] Findings HolderFindings(const SqliteFacts& facts, StoreHolder holder);

}  // namespace uplink::ctl
