#include "tools/uplinkctl/verbs/payload_text.h"

#include <cstddef>
#include <span>
#include <string>

#include <fmt/core.h>
#include <google/protobuf/empty.pb.h>

#include "schema/base/utf8.h"
#include "schema/decode/payload_text.h"
#include "schema/json/exact.h"
#include "tools/uplinkctl/show/json_text.h"

namespace uplink::ctl {
namespace {

constexpr std::size_t kBytesOfLine = 16;

std::string OfUplink(std::string_view payload) {
  return schema::PayloadText(std::as_bytes(std::span(payload.data(), payload.size())));
}

std::string OfCyberwave(std::string_view payload) {
  if (const auto value = uplink::json::ParseExact(payload)) return PrettyJson(*value) + "\n";
  return "no JSON: " + PrintableUtf8(payload, std::string::npos) + "\n";
}

/// A message without fields keeps those that it does not know, and prints them by number.
std::string OfUncrew(std::string_view payload) {
  google::protobuf::Empty message;
  const bool whole =
      message.ParsePartialFromArray(payload.data(), static_cast<int>(payload.size()));
  const std::string fields = message.DebugString();
  if (!whole && fields.empty()) return "no message of protobuf\n";
  return (whole ? "" : "cut, or no message of protobuf; until there:\n") + fields;
}

}  // namespace

std::string HexText(std::string_view bytes) {
  std::string text;
  for (std::size_t at = 0; at < bytes.size(); at += kBytesOfLine) {
    const std::string_view line = bytes.substr(at, kBytesOfLine);
    std::string hex;
    std::string ascii;
    for (std::size_t i = 0; i < line.size(); ++i) {
      const auto byte = static_cast<unsigned char>(line[i]);
      if (i == kBytesOfLine / 2) hex += ' ';
      hex += fmt::format(" {:02x}", byte);
      ascii += byte >= ' ' && byte < 0x7F ? line[i] : '.';
    }
    text += fmt::format("{:08x} {:<49}  {}\n", at, hex, ascii);
  }
  return text;
}

std::string DecodedText(std::string_view source, std::string_view payload) {
  if (payload.empty()) return "the payload was not kept\n";
  if (source == "uplink") return OfUplink(payload);
  if (source == "cyberwave") return OfCyberwave(payload);
  if (source == "uncrew") return OfUncrew(payload);
  return "a source that this uplinkctl does not know\n";
}

}  // namespace uplink::ctl
