#include "server/view/json.h"

#include <cstddef>
#include <memory>

#include <absl/status/status.h>
#include <fmt/core.h>
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/util/json_util.h>
#include <google/protobuf/util/type_resolver.h>
#include <google/protobuf/util/type_resolver_util.h>

#include "schema/base/utf8.h"
#include "server/view/messages.h"

namespace uplink::view {
namespace {

/// Bytes of a text in an error; enough for a RURI with every byte shown as hex.
constexpr std::size_t kErrorTextBytesMax = 2048;

/// The wire form with the members of maps in order, so that the same answer is the same text.
std::string Ordered(const google::protobuf::Message& message) {
  std::string bytes;
  {
    google::protobuf::io::StringOutputStream stream(&bytes);
    google::protobuf::io::CodedOutputStream coded(&stream);
    coded.SetSerializationDeterministic(true);
    message.SerializeToCodedStream(&coded);
  }
  return bytes;
}

/// A text as JSON string. PrintableUtf8 leaves no control character in it.
std::string Quoted(std::string_view text) {
  std::string json = "\"";
  for (const char c : PrintableUtf8(text, kErrorTextBytesMax)) {
    if (c == '"' || c == '\\') json += '\\';
    json += c;
  }
  return json + '"';
}

}  // namespace

absl::StatusOr<std::string> PrintJson(const google::protobuf::Message& message) {
  constexpr const char* kPrefix = "type.googleapis.com";
  const std::unique_ptr<google::protobuf::util::TypeResolver> types(
      google::protobuf::util::NewTypeResolverForDescriptorPool(
          kPrefix, google::protobuf::DescriptorPool::generated_pool()));
  google::protobuf::util::JsonPrintOptions options;
  options.always_print_primitive_fields = true;
  std::string json;
  const auto status = google::protobuf::util::BinaryToJsonString(
      types.get(), fmt::format("{}/{}", kPrefix, message.GetTypeName()), Ordered(message), &json,
      options);
  if (!status.ok()) {
    return absl::InternalError(fmt::format("{} has no JSON form: {}", message.GetTypeName(),
                                           std::string(status.message())));
  }
  return json;
}

absl::StatusOr<std::string> ToJson(const RobotView& robot, const PartSet& parts) {
  return PrintJson(ToMessage(robot, parts));
}

absl::StatusOr<std::string> ToJson(const RobotsPage& page, const PartSet& parts) {
  return PrintJson(ToMessage(page, parts));
}

absl::StatusOr<std::string> ToJson(const StatusView& status,
                                   const std::vector<std::string>& degraded) {
  return PrintJson(ToMessage(status, degraded));
}

std::string WordsJson(std::string_view key, const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) {
    if (!list.empty()) list += ',';
    list += Quoted(word);
  }
  return fmt::format("{{{}:[{}]}}", Quoted(key), list);
}

std::string ErrorJson(const ErrorText& error) {
  std::string json = fmt::format(R"({{"error":{{"code":{},"message":{})", Quoted(error.code),
                                 Quoted(error.message));
  if (!error.field.empty()) json += fmt::format(R"(,"field":{})", Quoted(error.field));
  return json + "}}";
}

}  // namespace uplink::view
