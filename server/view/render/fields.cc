#include "server/view/render/fields.h"

namespace uplink::view {

using google::protobuf::ListValue;
using google::protobuf::Struct;
using google::protobuf::Value;

Value NullJson() {
  Value value;
  value.set_null_value(google::protobuf::NULL_VALUE);
  return value;
}

Value Json(const std::string& text) {
  Value value;
  value.set_string_value(text);
  return value;
}

Value Json(Struct fields) {
  Value value;
  *value.mutable_struct_value() = std::move(fields);
  return value;
}

Value Json(ListValue items) {
  Value value;
  *value.mutable_list_value() = std::move(items);
  return value;
}

Value Json(Value value) { return value; }

}  // namespace uplink::view
