#pragma once

#include <cstdint>

#include "schema/model/enum_text.h"

namespace uplink::storage::postgres {

/// The number as it came: one that we do not know is kept.
template <model::WireEnum E>
[[nodiscard]] std::int32_t NumberOf(E member) {
  return static_cast<std::int32_t>(static_cast<std::uint16_t>(member));
}

/// The member that NumberOf wrote.
template <model::WireEnum E>
[[nodiscard]] E MemberOf(std::int64_t column) {
  return static_cast<E>(static_cast<std::uint16_t>(column));
}

}  // namespace uplink::storage::postgres
