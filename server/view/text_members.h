#pragma once

#include <string>
#include <string_view>

#include <boost/json/fwd.hpp>

namespace uplink::view {

/// Members of a JSON object whose values are texts: what a store keeps, and what robots said. An
/// answer has them as they are. Read into a Struct of protobuf, each of their bytes would take up
/// to 200. A value.
class TextMembers final {
 public:
  /// `text` is an object that a store keeps. What is no object stands as `{}`, so that no row
  /// breaks the answer.
  void AddStored(std::string_view name, std::string_view text);
  void Add(std::string_view name, const boost::json::object& value);

  /// `,"name":{...}` of each, in the order in which they were added.
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  void AddText(std::string_view name, std::string_view text);

  std::string text_;
};

}  // namespace uplink::view
