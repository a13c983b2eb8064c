#include "tools/uplinkctl/show/json_text.h"

#include <algorithm>
#include <cstdint>
#include <string_view>

#include <fmt/core.h>

#include "schema/base/utf8.h"

namespace uplink::ctl {
namespace {

namespace json = boost::json;

constexpr std::uint32_t kFirstOfPairs = 0x10000;

std::string EscapeOf(std::uint32_t code) {
  if (code < kFirstOfPairs) return fmt::format("\\u{:04x}", code);
  const std::uint32_t rest = code - kFirstOfPairs;
  return fmt::format("\\u{:04x}\\u{:04x}", 0xD800U + (rest >> 10U), 0xDC00U + (rest & 0x3FFU));
}

/// Text that the library wrote, whose characters of ASCII but DEL are fit to show.
std::string Shown(std::string_view text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const auto lead = static_cast<unsigned char>(text[at]);
    if (lead < 0x7F) {
      out += text[at++];
      continue;
    }
    std::size_t bytes = 1;
    while (at + bytes < text.size() &&
           (static_cast<unsigned char>(text[at + bytes]) & 0xC0U) == 0x80U) {
      ++bytes;
    }
    const std::string_view character = text.substr(at, bytes);
    if (PrintableUtf8(character, std::string::npos) == character) {
      out += character;
    } else {
      std::uint32_t code = bytes == 1 ? lead : lead & (0xFFU >> (bytes + 1));
      for (const char c : character.substr(1)) {
        code = code << 6U | (static_cast<unsigned char>(c) & 0x3FU);
      }
      out += EscapeOf(code);
    }
    at += bytes;
  }
  return out;
}

/// The library writes 1.5 as 1.5E0.
std::string Number(double number) { return fmt::format("{}", number); }

template <typename Each>
std::string Joined(char open, char close, std::size_t count, int depth, Each each) {
  if (count == 0) return {open, close};
  const bool one_line = depth < 0;
  const std::string inner =
      one_line ? "" : "\n" + std::string(2 * (static_cast<std::size_t>(depth) + 1), ' ');
  const std::string outer =
      one_line ? "" : "\n" + std::string(2 * static_cast<std::size_t>(depth), ' ');
  std::string text(1, open);
  for (std::size_t i = 0; i < count; ++i) text += (i == 0 ? "" : ",") + inner + each(i);
  return text + outer + close;
}

/// `depth` below 0: on one line.
std::string Text(const json::value& value, int depth) {
  const int below = depth < 0 ? depth : depth + 1;
  if (const auto* object = value.if_object()) {
    return Joined('{', '}', object->size(), depth, [&](std::size_t i) {
      const auto& member = *(object->begin() + static_cast<std::ptrdiff_t>(i));
      return json::serialize(json::string(member.key())) + (depth < 0 ? ":" : ": ") +
             Text(member.value(), below);
    });
  }
  if (const auto* array = value.if_array()) {
    return Joined('[', ']', array->size(), depth,
                  [&](std::size_t i) { return Text((*array)[i], below); });
  }
  if (const auto* number = value.if_double()) return Number(*number);
  return json::serialize(value);
}

}  // namespace

std::string LineJson(const json::value& value) { return Shown(Text(value, -1)); }

std::string PrettyJson(const json::value& value) { return Shown(Text(value, 0)); }

std::string ScalarText(const json::value& value) {
  if (value.is_null()) return {};
  if (const auto* text = value.if_string()) return {text->data(), text->size()};
  return Text(value, -1);
}

}  // namespace uplink::ctl
