#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "schema/model/enum_text.h"

namespace uplink::storage::sqlite {

/// A text to bind; it must outlive the run.
[[nodiscard]] inline std::string_view View(const std::string& text) { return text; }

/// The number as it came: one that we do not know is kept.
template <model::WireEnum E>
[[nodiscard]] std::int64_t NumberOf(E member) {
  return static_cast<std::int64_t>(static_cast<std::uint16_t>(member));
}

/// The member that NumberOf wrote.
template <model::WireEnum E>
[[nodiscard]] E MemberOf(std::int64_t column) {
  return static_cast<E>(static_cast<std::uint16_t>(column));
}

}  // namespace uplink::storage::sqlite
