#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

#include "schema/model/enum_text.h"

namespace uplink::model {

/// The `enum` member of Value: a name, kept apart from an ordinary string.
struct EnumName {
  std::string name;

  friend bool operator==(const EnumName&, const EnumName&) = default;
};

/// A scalar of a reading or a setting; the alternatives stand in the order of the wire's union:
/// string, int, number, bool, enum.
using Value = std::variant<std::string, std::int32_t, double, bool, EnumName>;

/// What a sensor or setting declares its values to be; the numbers are Value's indices.
enum class ValueType : std::uint16_t { kString = 0, kInt = 1, kNumber = 2, kBool = 3, kEnum = 4 };
template <>
inline constexpr auto kEnumNames<ValueType> =
    std::to_array<std::string_view>({"string", "int", "number", "bool", "enum"});
static_assert(kEnumNames<ValueType>.size() == std::variant_size_v<Value>);

/// The type of the scalar that a Value holds.
[[nodiscard]] inline ValueType TypeOf(const Value& value) {
  return static_cast<ValueType>(value.index());
}

}  // namespace uplink::model
