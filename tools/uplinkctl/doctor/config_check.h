#pragma once

#include <set>
#include <string>

#include "server/config/load.h"
#include "tools/uplinkctl/doctor/finding.h"

namespace uplink::ctl {

/// What the server's own parser says of the configuration, and of the files that it names
/// (config::WithFiles). `file` is the configuration's, `user` who looked at the files. A pure
/// function.
[[nodiscard]] Findings ConfigFindings(const config::LoadResult& result, const std::string& file,
                                      const std::string& user);

/// Keys with a problem. What they name is not checked further: many hold their defaults.
[[nodiscard]] std::set<std::string> KeysAtFault(const config::LoadResult& result);

}  // namespace uplink::ctl
