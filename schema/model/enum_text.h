#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

namespace uplink::model {

/// The specification's names of an enumeration's members, by number. Each enumeration of the wire
/// specialises it beside its definition; the numbers are dense from 0.
template <typename E>
inline constexpr std::array<std::string_view, 0> kEnumNames{};

/// An enumeration of the wire: 16 bits, so that a number we do not know yet is kept as it came.
template <typename E>
concept WireEnum = std::is_enum_v<E> && std::same_as<std::underlying_type_t<E>, std::uint16_t> &&
    (kEnumNames<E>.size() > 0);

/// An enumeration of protobuf: 32 bits, so that a number we do not know yet is kept as it came.
/// Numbers need not be dense; the name in a gap is empty.
template <typename E>
concept OpenEnum = std::is_enum_v<E> && std::same_as<std::underlying_type_t<E>, std::int32_t> &&
    (kEnumNames<E>.size() > 0);

/// True if the specification that we know names this member.
template <WireEnum E>
[[nodiscard]] constexpr bool IsRecognized(E value) {
  return static_cast<std::size_t>(value) < kEnumNames<E>.size();
}
template <OpenEnum E>
[[nodiscard]] constexpr bool IsRecognized(E value) {
  const auto number = static_cast<std::int32_t>(value);
  return number >= 0 && static_cast<std::size_t>(number) < kEnumNames<E>.size() &&
         !kEnumNames<E>[static_cast<std::size_t>(number)].empty();
}

/// How a number beyond the known members is shown: `unrecognized_12`.
[[nodiscard]] std::string UnrecognizedText(std::int32_t number);
/// The number in such a text; nothing for any other text.
[[nodiscard]] std::optional<std::uint16_t> UnrecognizedFromText(std::string_view text);

/// The member's name in the specification, or `unrecognized_N`.
template <WireEnum E>
[[nodiscard]] std::string EnumText(E value) {
  if (!IsRecognized(value)) return UnrecognizedText(static_cast<std::uint16_t>(value));
  return std::string(kEnumNames<E>[static_cast<std::size_t>(value)]);
}
template <OpenEnum E>
[[nodiscard]] std::string EnumText(E value) {
  if (!IsRecognized(value)) return UnrecognizedText(static_cast<std::int32_t>(value));
  return std::string(kEnumNames<E>[static_cast<std::size_t>(value)]);
}

/// The member that EnumText spells so, or nothing.
template <WireEnum E>
[[nodiscard]] std::optional<E> EnumFromText(std::string_view text) {
  for (std::size_t i = 0; i < kEnumNames<E>.size(); ++i) {
    if (kEnumNames<E>[i] == text) return static_cast<E>(i);
  }
  const std::optional<std::uint16_t> number = UnrecognizedFromText(text);
  if (!number || *number < kEnumNames<E>.size()) return std::nullopt;
  return static_cast<E>(*number);
}

}  // namespace uplink::model
