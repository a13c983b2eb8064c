#pragma once

#include <concepts>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <google/protobuf/struct.pb.h>

#include "schema/model/enum_text.h"

/// Building blocks of the renderings: scalars and structs as google.protobuf.Value, and a Struct
/// filled name by name.
namespace uplink::view {

template <typename T>
concept Number = (std::integral<T> || std::floating_point<T>)&&!std::same_as<T, bool>;

[[nodiscard]] google::protobuf::Value NullJson();

/// JSON has one kind of number, a double: integers beyond 2^53 lose their last bits.
template <Number T>
[[nodiscard]] google::protobuf::Value Json(T number) {
  google::protobuf::Value value;
  value.set_number_value(static_cast<double>(number));
  return value;
}

template <std::same_as<bool> T>
[[nodiscard]] google::protobuf::Value Json(T flag) {
  google::protobuf::Value value;
  value.set_bool_value(flag);
  return value;
}

template <model::WireEnum E>
[[nodiscard]] google::protobuf::Value Json(E member) {
  google::protobuf::Value value;
  value.set_string_value(model::EnumText(member));
  return value;
}

[[nodiscard]] google::protobuf::Value Json(const std::string& text);
[[nodiscard]] google::protobuf::Value Json(google::protobuf::Struct fields);
[[nodiscard]] google::protobuf::Value Json(google::protobuf::ListValue items);
[[nodiscard]] google::protobuf::Value Json(google::protobuf::Value value);

/// A Struct in the making.
class Fields {
 public:
  template <typename T>
  Fields& Set(std::string_view name, T&& value) {
    (*fields_.mutable_fields())[std::string(name)] = Json(std::forward<T>(value));
    return *this;
  }
  template <typename T>
  Fields& SetIf(std::string_view name, const std::optional<T>& value) {
    if (value) Set(name, *value);
    return *this;
  }
  [[nodiscard]] google::protobuf::Struct Take() { return std::move(fields_); }

 private:
  google::protobuf::Struct fields_;
};

/// The list of what `render` makes of each item.
template <typename Items, typename RenderItem>
[[nodiscard]] google::protobuf::ListValue ListOf(const Items& items, RenderItem render) {
  google::protobuf::ListValue list;
  list.mutable_values()->Reserve(static_cast<int>(items.size()));
  for (const auto& item : items) *list.add_values() = Json(render(item));
  return list;
}

}  // namespace uplink::view
