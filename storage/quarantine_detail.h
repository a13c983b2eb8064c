#pragma once

#include <cstdint>

namespace uplink::storage {

/// How much of a rejected payload its row keeps: less where the database refuses more.
enum class QuarantineDetail : std::uint8_t { kAll, kWithoutPayload, kBare };

}  // namespace uplink::storage
