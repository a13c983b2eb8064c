#include "server/view/message_printer.h"

#include <absl/status/status.h>
#include <fmt/core.h>
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/message.h>
#include <google/protobuf/util/json_util.h>
#include <google/protobuf/util/type_resolver.h>
#include <google/protobuf/util/type_resolver_util.h>

#include "schema/base/check.h"

namespace uplink::view {
namespace {

constexpr const char* kPrefix = "type.googleapis.com";

/// The wire form with the members of maps in order, so that equal answers have equal texts.
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

}  // namespace

MessagePrinter::MessagePrinter()
    : types_(google::protobuf::util::NewTypeResolverForDescriptorPool(
          kPrefix, google::protobuf::DescriptorPool::generated_pool())) {}

MessagePrinter::~MessagePrinter() = default;

absl::StatusOr<std::string> MessagePrinter::Print(const google::protobuf::Message& message,
                                                  const TextMembers& texts) const {
  google::protobuf::util::JsonPrintOptions options;
  options.always_print_primitive_fields = true;
  std::string json;
  const auto status = google::protobuf::util::BinaryToJsonString(
      types_.get(), fmt::format("{}/{}", kPrefix, message.GetTypeName()), Ordered(message), &json,
      options);
  if (!status.ok()) {
    return absl::InternalError(fmt::format("{} has no JSON form: {}", message.GetTypeName(),
                                           std::string(status.message())));
  }
  if (texts.text().empty()) return json;
  UPLINK_CHECK(json.size() > 2 && json.back() == '}', "a message with texts has scalars");
  json.reserve(json.size() + texts.text().size());
  json.pop_back();
  json += texts.text();
  json += '}';
  return json;
}

}  // namespace uplink::view
