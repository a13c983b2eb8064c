#include "tools/uplink-fleet/drone/shown.h"

#include <cctype>
#include <string>

#include <google/protobuf/descriptor.h>

namespace uplink::synthetic {
namespace {

namespace js = boost::json;
using google::protobuf::EnumValueDescriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

/// `GPS_FIX_TYPE_FIX_3D` of GpsFixType is `fix_3d`.
std::string NameOf(const EnumValueDescriptor& value) {
  std::size_t prefix = 0;
  for (const char c : value.type()->name()) prefix += std::isupper(c) != 0 ? 2U : 1U;
  std::string name = value.name().substr(prefix);
  for (char& c : name) c = static_cast<char>(std::tolower(c));
  return name;
}

// NOLINTNEXTLINE(misc-no-recursion): the depth is that of the contract's messages
js::value ValueOf(const Message& message, const FieldDescriptor& field) {
  const auto* look = message.GetReflection();
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_BOOL:
      return look->GetBool(message, &field);
    case FieldDescriptor::CPPTYPE_INT32:
      return look->GetInt32(message, &field);
    case FieldDescriptor::CPPTYPE_UINT32:
      return look->GetUInt32(message, &field);
    case FieldDescriptor::CPPTYPE_INT64:
      return look->GetInt64(message, &field);
    case FieldDescriptor::CPPTYPE_UINT64:
      return look->GetUInt64(message, &field);
    case FieldDescriptor::CPPTYPE_FLOAT:
      return static_cast<double>(look->GetFloat(message, &field));
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return look->GetDouble(message, &field);
    case FieldDescriptor::CPPTYPE_ENUM:
      return js::value(NameOf(*look->GetEnum(message, &field)));
    case FieldDescriptor::CPPTYPE_STRING:
      return js::value(look->GetString(message, &field));
    case FieldDescriptor::CPPTYPE_MESSAGE:
      break;
  }
  const Message& within = look->GetMessage(message, &field);
  const FieldDescriptor* first = within.GetDescriptor()->field(0);
  if (!first->is_repeated()) return ShownOf(within);
  // A covariance is its values.
  js::array values;
  const auto* list = within.GetReflection();
  for (int i = 0; i < list->FieldSize(within, first); ++i) {
    values.emplace_back(static_cast<double>(list->GetRepeatedFloat(within, first, i)));
  }
  return values;
}

bool SaysNothing(const js::value& value) {
  return (value.is_string() && value.get_string().empty()) ||
         (value.is_object() && value.get_object().empty()) ||
         (value.is_array() && value.get_array().empty());
}

}  // namespace

// NOLINTNEXTLINE(misc-no-recursion): see above
js::object ShownOf(const Message& sample, std::string_view key) {
  js::object shown;
  const auto* type = sample.GetDescriptor();
  for (int i = 0; i < type->field_count(); ++i) {
    const FieldDescriptor& field = *type->field(i);
    if (field.name() == key) continue;
    if (field.has_presence() && !sample.GetReflection()->HasField(sample, &field)) continue;
    js::value value = ValueOf(sample, field);
    if (!SaysNothing(value)) shown[field.json_name()] = std::move(value);
  }
  return shown;
}

}  // namespace uplink::synthetic
