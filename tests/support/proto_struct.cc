#include "tests/support/proto_struct.h"

#include <google/protobuf/util/json_util.h>

namespace uplink::test {
namespace {

using google::protobuf::ListValue;
using google::protobuf::Struct;
using google::protobuf::Value;

std::string Copy(boost::json::string_view text) { return {text.data(), text.size()}; }

Value ToValue(const boost::json::value& json) {
  Value value;
  switch (json.kind()) {
    case boost::json::kind::null:
      value.set_null_value(google::protobuf::NULL_VALUE);
      break;
    case boost::json::kind::bool_:
      value.set_bool_value(json.get_bool());
      break;
    case boost::json::kind::int64:
      value.set_number_value(static_cast<double>(json.get_int64()));
      break;
    case boost::json::kind::uint64:
      value.set_number_value(static_cast<double>(json.get_uint64()));
      break;
    case boost::json::kind::double_:
      value.set_number_value(json.get_double());
      break;
    case boost::json::kind::string:
      value.set_string_value(Copy(json.get_string()));
      break;
    case boost::json::kind::array:
      value.mutable_list_value()->mutable_values()->Reserve(
          static_cast<int>(json.get_array().size()));
      for (const auto& item : json.get_array()) {
        *value.mutable_list_value()->add_values() = ToValue(item);
      }
      break;
    case boost::json::kind::object:
      *value.mutable_struct_value() = ToStruct(json.get_object());
      break;
  }
  return value;
}

}  // namespace

Struct ToStruct(const boost::json::object& object) {
  Struct result;
  auto& fields = *result.mutable_fields();
  for (const auto& [key, value] : object) fields[Copy(key)] = ToValue(value);
  return result;
}

Struct ParseStruct(std::string_view text) {
  Struct result;
  // Not by Boost.JSON, whose reader (1.81) may miss a double by its last bit.
  const auto status = google::protobuf::util::JsonStringToMessage(
      google::protobuf::StringPiece(text.data(), text.size()), &result);
  if (!status.ok()) result.Clear();
  return result;
}

}  // namespace uplink::test
