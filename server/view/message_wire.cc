#include "server/view/message_wire.h"

#include <bit>
#include <cstddef>

#include <boost/json.hpp>
#include <google/protobuf/descriptor.h>

#include "schema/base/check.h"

namespace uplink::view {
namespace {

namespace json = boost::json;

// Types of the wire, and the fields of google/protobuf/struct.proto.
constexpr std::uint32_t kVarint = 0;
constexpr std::uint32_t kFixed64 = 1;
constexpr std::uint32_t kLength = 2;
constexpr std::uint32_t kFieldsOfStruct = 1;
constexpr std::uint32_t kKeyOfEntry = 1;
constexpr std::uint32_t kValueOfEntry = 2;
constexpr std::uint32_t kNull = 1;
constexpr std::uint32_t kNumber = 2;
constexpr std::uint32_t kText = 3;
constexpr std::uint32_t kBool = 4;
constexpr std::uint32_t kStruct = 5;
constexpr std::uint32_t kList = 6;
constexpr std::uint32_t kValuesOfList = 1;

/// Levels of a text: readers of protobuf take no more than a third as many (100, and three to a
/// level).
constexpr std::size_t kDepthMax = 100;

void AppendVarint(std::uint64_t value, std::string& wire) {
  constexpr std::uint64_t kMore = 0x80;
  for (; value >= kMore; value >>= 7U) wire += static_cast<char>(value | kMore);
  wire += static_cast<char>(value);
}

void AppendTag(std::uint32_t number, std::uint32_t type, std::string& wire) {
  AppendVarint(std::uint64_t{number} << 3U | type, wire);
}

void AppendNumber(double number, std::string& wire) {
  AppendTag(kNumber, kFixed64, wire);
  auto bits = std::bit_cast<std::uint64_t>(number);
  for (std::size_t i = 0; i < sizeof bits; ++i, bits >>= 8U)
    wire += static_cast<char>(bits & 0xFFU);
}

std::string StructOf(const json::object& object);

/// A google.protobuf.Value.
// NOLINTNEXTLINE(misc-no-recursion): the parser bounds the depth
std::string ValueOf(const json::value& value) {
  std::string wire;
  switch (value.kind()) {
    case json::kind::null:
      AppendTag(kNull, kVarint, wire);
      AppendVarint(0, wire);
      break;
    case json::kind::bool_:
      AppendTag(kBool, kVarint, wire);
      AppendVarint(value.get_bool() ? 1 : 0, wire);
      break;
    case json::kind::int64:
      AppendNumber(static_cast<double>(value.get_int64()), wire);
      break;
    case json::kind::uint64:
      AppendNumber(static_cast<double>(value.get_uint64()), wire);
      break;
    case json::kind::double_:
      AppendNumber(value.get_double(), wire);
      break;
    case json::kind::string:
      AppendField(kText, {value.get_string().data(), value.get_string().size()}, wire);
      break;
    case json::kind::array: {
      std::string list;
      for (const json::value& each : value.get_array()) {
        AppendField(kValuesOfList, ValueOf(each), list);
      }
      AppendField(kList, list, wire);
      break;
    }
    case json::kind::object:
      AppendField(kStruct, StructOf(value.get_object()), wire);
      break;
  }
  return wire;
}

// NOLINTNEXTLINE(misc-no-recursion): as above
std::string StructOf(const json::object& object) {
  std::string wire;
  for (const json::key_value_pair& member : object) {
    std::string entry;
    AppendField(kKeyOfEntry, {member.key().data(), member.key().size()}, entry);
    AppendField(kValueOfEntry, ValueOf(member.value()), entry);
    AppendField(kFieldsOfStruct, entry, wire);
  }
  return wire;
}

/// As an object with one member for each text; none if it cannot be read.
json::object MembersOf(const TextMembers& texts) {
  std::string text = texts.text();
  // It begins with the comma after the message's own members.
  text.front() = '{';
  text += '}';
  boost::system::error_code error;
  json::parse_options options;
  options.max_depth = kDepthMax;
  json::value parsed = json::parse(text, error, {}, options);
  return !error && parsed.is_object() ? std::move(parsed.get_object()) : json::object();
}

}  // namespace

void AppendField(std::uint32_t number, std::string_view value, std::string& wire) {
  AppendTag(number, kLength, wire);
  AppendVarint(value.size(), wire);
  wire += value;
}

std::string WireOf(const google::protobuf::Message& message, const TextMembers& texts) {
  std::string wire = message.SerializeAsString();
  if (texts.text().empty()) return wire;
  const google::protobuf::Descriptor& type = *message.GetDescriptor();
  for (const json::key_value_pair& member : MembersOf(texts)) {
    const auto* field = type.FindFieldByCamelcaseName(std::string(member.key()));
    UPLINK_CHECK(field != nullptr, "a text is a member of its message");
    const json::object* object = member.value().if_object();
    AppendField(static_cast<std::uint32_t>(field->number()),
                object == nullptr ? std::string() : StructOf(*object), wire);
  }
  return wire;
}

}  // namespace uplink::view
