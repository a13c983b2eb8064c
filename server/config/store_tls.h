#pragma once

#include <optional>
#include <string>

#include "server/config/config.h"

namespace uplink::config {

/// What is to be said of a store that is reached over a network and need not prove who it is
/// (storage/postgres/link/verified.h); nothing of any other.
///
/// Thread: any; reads the environment as libpq does.
[[nodiscard]] std::optional<std::string> UnverifiedStoreText(const StoreConfig& store);

}  // namespace uplink::config
