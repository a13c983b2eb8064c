#pragma once

#include <string>
#include <string_view>

#include <boost/json/fwd.hpp>

namespace uplink::view {

/// Members of a JSON object whose values are JSON texts already: from the store, or from robots. An
/// answer carries them as they are. Parsed into a Struct of protobuf, each of their bytes would
/// take up to 200. A value.
class TextMembers final {
 public:
  /// `text` is an object from the store. Anything else becomes `{}`, so that no row breaks the
  /// answer.
  void AddStored(std::string_view name, std::string_view text);
  void Add(std::string_view name, const boost::json::object& value);

  /// `,"name":{...}` for each, in the order in which they were added.
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  void AddText(std::string_view name, std::string_view text);

  std::string text_;
};

}  // namespace uplink::view
