#pragma once

#include <string>
#include <string_view>

#include "server/config/load.h"

namespace uplink::config::testing {

/// The least that a configuration must hold, on lines 1 to 4.
inline constexpr std::string_view kMinimal =
    "[tls]\n"
    "certificate_file = \"s.crt\"\n"
    "key_file = \"s.key\"\n"
    "client_ca_file = \"ca.crt\"\n";

/// kMinimal, then `more` from line 5 on.
inline LoadResult ParseWith(std::string_view more, const Environment& environment = {}) {
  return ParseConfig(std::string(kMinimal) + std::string(more), "u.toml", environment);
}

}  // namespace uplink::config::testing
