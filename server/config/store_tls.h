#pragma once

#include <optional>
#include <string>

#include "server/config/config.h"

namespace uplink::config {

/// A warning if the store is reached over a network and need not prove its identity
/// (storage/postgres/link/verified.h); nothing otherwise.
///
/// Thread: any; reads the environment as libpq does.
[[nodiscard]] std::optional<std::string> UnverifiedStoreText(const StoreConfig& store);

}  // namespace uplink::config
