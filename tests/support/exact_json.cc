#include "tests/support/exact_json.h"

#include <google/protobuf/struct.pb.h>
#include <google/protobuf/util/json_util.h>

namespace uplink::test {
namespace {

using boost::json::array;
using boost::json::object;
using boost::json::value;

value FromProto(const google::protobuf::Value& from);

object FromProto(const google::protobuf::Struct& from) {
  object result;
  for (const auto& [key, member] : from.fields()) result[key] = FromProto(member);
  return result;
}

value FromProto(const google::protobuf::Value& from) {
  using google::protobuf::Value;
  if (from.kind_case() == Value::kBoolValue) return from.bool_value();
  if (from.kind_case() == Value::kNumberValue) return from.number_value();
  if (from.kind_case() == Value::kStringValue) return value(from.string_value());
  if (from.kind_case() == Value::kStructValue) return FromProto(from.struct_value());
  if (from.kind_case() != Value::kListValue) return nullptr;
  array list;
  for (const auto& item : from.list_value().values()) list.push_back(FromProto(item));
  return list;
}

}  // namespace

std::optional<object> ParseExact(std::string_view text) {
  google::protobuf::Struct parsed;
  const auto status = google::protobuf::util::JsonStringToMessage(
      google::protobuf::StringPiece(text.data(), text.size()), &parsed);
  if (!status.ok()) return std::nullopt;
  return FromProto(parsed);
}

}  // namespace uplink::test
