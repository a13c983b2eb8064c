#pragma once

#include <concepts>

namespace uplink {

/// Value is one of Types: for an overload of std::visit that takes those alone, so that a type
/// which the variant gets later does not compile until somebody says what becomes of it.
template <typename Value, typename... Types>
concept OneOf = (std::same_as<Value, Types> || ...);

}  // namespace uplink
