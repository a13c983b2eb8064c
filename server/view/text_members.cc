#include "server/view/text_members.h"

#include <boost/json.hpp>

#include "schema/json/object_text.h"

namespace uplink::view {

void TextMembers::AddStored(std::string_view name, std::string_view text) {
  AddText(name, json::IsObjectText(text) ? text : "{}");
}

void TextMembers::Add(std::string_view name, const boost::json::object& value) {
  AddText(name, boost::json::serialize(value));
}

void TextMembers::AddText(std::string_view name, std::string_view text) {
  text_ += ",\"";
  text_ += name;
  text_ += "\":";
  text_ += text;
}

}  // namespace uplink::view
