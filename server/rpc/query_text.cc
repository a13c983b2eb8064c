#include "server/rpc/query_text.h"

#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <google/protobuf/descriptor.h>
#include <google/protobuf/timestamp.pb.h>
#include <google/protobuf/util/time_util.h>

#include "schema/base/check.h"

namespace uplink::rpc {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

/// The list that a query writes with commas.
constexpr std::string_view kWithCommas = "parts";

void AppendEncoded(std::string_view text, std::string& query) {
  constexpr std::string_view kPlain =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~";
  for (const char c : text) {
    if (kPlain.find(c) != std::string_view::npos) {
      query += c;
    } else {
      query += fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
  }
}

std::string TextOfTime(const Message& value) {
  google::protobuf::Timestamp time;
  UPLINK_CHECK(value.GetDescriptor() == time.GetDescriptor(),
               "each message within a request is a time");
  time.CopyFrom(value);
  return google::protobuf::util::TimeUtil::ToString(time);
}

std::string TextOf(const Message& request, const FieldDescriptor& field) {
  const google::protobuf::Reflection& fields = *request.GetReflection();
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_STRING:
      return fields.GetString(request, &field);
    case FieldDescriptor::CPPTYPE_BOOL:
      return fields.GetBool(request, &field) ? "true" : "false";
    case FieldDescriptor::CPPTYPE_INT32:
      return fmt::format("{}", fields.GetInt32(request, &field));
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return fmt::format("{}", fields.GetDouble(request, &field));
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return TextOfTime(fields.GetMessage(request, &field));
    default:  // a foreign enumeration
      break;
  }
  UPLINK_CHECK(false, "a request has a field of a new type");
  return {};
}

void AppendList(const Message& request, const FieldDescriptor& field, std::string& query) {
  const google::protobuf::Reflection& fields = *request.GetReflection();
  UPLINK_CHECK(field.cpp_type() == FieldDescriptor::CPPTYPE_STRING,
               "each list within a request is of texts");
  std::string words;
  for (int i = 0; i < fields.FieldSize(request, &field); ++i) {
    const std::string text = fields.GetRepeatedString(request, &field, i);
    if (field.json_name() != kWithCommas) {
      AppendParameter(field.json_name(), text, query);
    } else {
      words += (i == 0 ? "" : ",") + text;
    }
  }
  if (!words.empty()) AppendParameter(field.json_name(), words, query);
}

}  // namespace

void AppendParameter(std::string_view name, std::string_view value, std::string& query) {
  if (!query.empty()) query += '&';
  query += name;
  query += '=';
  AppendEncoded(value, query);
}

std::string QueryOf(const Message& request) {
  std::string query;
  std::vector<const FieldDescriptor*> set;
  request.GetReflection()->ListFields(request, &set);
  for (const FieldDescriptor* field : set) {
    if (field->is_repeated()) {
      AppendList(request, *field, query);
    } else {
      AppendParameter(field->json_name(), TextOf(request, *field), query);
    }
  }
  return query;
}

}  // namespace uplink::rpc
