#include "schema/decode/payload_text.h"

#include <algorithm>
#include <cstring>
#include <string_view>

#include <capnp/pretty-print.h>

#include "schema/base/utf8.h"
#include "schema/decode/message.h"
#include "schema/uplink.capnp.h"

namespace uplink::schema {
namespace {

std::string Unreadable(std::string_view why) {
  return "it cannot be read: " + PrintableUtf8(why, std::string::npos) + "\n";
}

/// Line by line, since a line end is no printable character.
std::string Printable(std::string_view text) {
  std::string shown;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    shown += PrintableUtf8(line, std::string::npos) + '\n';
    text.remove_prefix(std::min(text.size(), line.size() + 1));
  }
  return shown;
}

}  // namespace

std::string PayloadText(std::span<const std::byte> payload) {
  if (const std::string_view error = FramingError(payload); !error.empty()) {
    return Unreadable(error);
  }
  auto words = kj::heapArray<capnp::word>(payload.size() / kWordBytes);
  std::memcpy(words.begin(), payload.data(), payload.size());
  const auto read = [](capnp::FlatArrayMessageReader& reader) {
    const kj::String text = capnp::prettyPrint(reader.getRoot<wire::UplinkMsg>()).flatten();
    return Printable({text.begin(), text.size()});
  };
  return ReadMessage(words.asPtr().asConst(), read, Unreadable);
}

}  // namespace uplink::schema
