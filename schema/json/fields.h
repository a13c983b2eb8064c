#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <boost/json.hpp>

#include "schema/model/enum_text.h"

/// Building blocks of the renderings: scalars as JSON values, and an object filled name by name.
namespace uplink::json {

template <typename T>
concept Scalar = std::integral<T> || std::floating_point<T> || std::same_as<T, std::string>;

/// Integers stay whole to 64 bits, a float is the double that it is.
template <Scalar T>
[[nodiscard]] boost::json::value Json(const T& scalar) {
  return boost::json::value(scalar);
}

template <model::WireEnum E>
[[nodiscard]] boost::json::value Json(E member) {
  return boost::json::value(model::EnumText(member));
}

[[nodiscard]] inline boost::json::value Json(boost::json::object fields) { return fields; }
[[nodiscard]] inline boost::json::value Json(boost::json::array items) { return items; }
[[nodiscard]] inline boost::json::value Json(boost::json::value value) { return value; }

/// An object in the making.
class Fields {
 public:
  template <typename T>
  Fields& Set(std::string_view name, T&& value) {
    fields_[boost::json::string_view(name.data(), name.size())] = Json(std::forward<T>(value));
    return *this;
  }
  template <typename T>
  Fields& SetIf(std::string_view name, const std::optional<T>& value) {
    if (value) Set(name, *value);
    return *this;
  }
  [[nodiscard]] boost::json::object Take() { return std::move(fields_); }

 private:
  boost::json::object fields_;
};

/// The list of what `render` makes of each item.
template <typename Items, typename RenderItem>
[[nodiscard]] boost::json::array ListOf(const Items& items, RenderItem render) {
  boost::json::array list;
  list.reserve(items.size());
  for (const auto& item : items) list.push_back(Json(render(item)));
  return list;
}

}  // namespace uplink::json
