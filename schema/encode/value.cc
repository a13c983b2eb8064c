#include <type_traits>
#include <variant>

#include "schema/encode/encode_body.h"

namespace uplink::schema {

void EncodeValue(const model::Value& in, wire::Value::Builder out) {
  std::visit(
      [&](const auto& value) {
        using T = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<T, std::string>) {
          out.setString(Text(value));
        } else if constexpr (std::is_same_v<T, std::int32_t>) {
          out.setInt(value);
        } else if constexpr (std::is_same_v<T, double>) {
          out.setNumber(value);
        } else if constexpr (std::is_same_v<T, bool>) {
          out.setBool(value);
        } else {
          static_assert(std::is_same_v<T, model::EnumName>);
          out.setEnum(Text(value.name));
        }
      },
      in);
}

}  // namespace uplink::schema
