#include "tests/support/http2_frames.h"

#include <algorithm>

namespace uplink::testing::http2 {
namespace {

constexpr std::size_t kFramePayloadMax = 16 * 1024;

std::string BytesOf(std::uint32_t number, std::size_t bytes) {
  std::string text(bytes, '\0');
  for (std::size_t i = 0; i < bytes; ++i) {
    text[i] = static_cast<char>((number >> (8 * (bytes - 1 - i))) & 0xFFU);
  }
  return text;
}

/// A string literal of HPACK, without Huffman's code.
void AppendText(std::string& block, std::string_view text) {
  constexpr std::size_t kPrefixMax = 127;
  if (text.size() < kPrefixMax) {
    block += static_cast<char>(text.size());
  } else {
    block += static_cast<char>(kPrefixMax);
    std::size_t rest = text.size() - kPrefixMax;
    for (; rest >= 128; rest /= 128) block += static_cast<char>(128 + rest % 128);
    block += static_cast<char>(rest);
  }
  block += text;
}

}  // namespace

std::string Preface() { return "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"; }

std::string Frame(std::uint8_t type, std::uint8_t flags, std::uint32_t stream,
                  std::string_view payload) {
  std::string frame = BytesOf(static_cast<std::uint32_t>(payload.size()), 3);
  frame += static_cast<char>(type);
  frame += static_cast<char>(flags);
  frame += BytesOf(stream, 4);
  frame += payload;
  return frame;
}

std::string Hpack(const Fields& fields) {
  std::string block;
  for (const auto& [name, value] : fields) {
    block += '\0';
    AppendText(block, name);
    AppendText(block, value);
  }
  return block;
}

std::string Headers(std::uint32_t stream, const Fields& fields, std::uint8_t flags) {
  return Frame(kHeaders, flags, stream, Hpack(fields));
}

std::string Data(std::uint32_t stream, std::string_view bytes, std::uint8_t flags) {
  std::string frames;
  do {
    const std::string_view part = bytes.substr(0, kFramePayloadMax);
    bytes.remove_prefix(part.size());
    frames += Frame(kData, bytes.empty() ? flags : std::uint8_t{kNone}, stream, part);
  } while (!bytes.empty());
  return frames;
}

std::string RstStream(std::uint32_t stream, std::uint32_t code) {
  return Frame(kRstStream, kNone, stream, BytesOf(code, 4));
}

std::string Settings(const std::vector<std::pair<std::uint16_t, std::uint32_t>>& values) {
  std::string payload;
  for (const auto& [id, value] : values) payload += BytesOf(id, 2) + BytesOf(value, 4);
  return Frame(kSettings, kNone, 0, payload);
}

std::string SettingsAck() { return Frame(kSettings, kAck, 0); }

std::string Ping(std::string_view eight_bytes) { return Frame(kPing, kNone, 0, eight_bytes); }

std::string Pong() { return Frame(kPing, kAck, 0, std::string(8, '\0')); }

std::string Priority(std::uint32_t stream) {
  constexpr std::string_view kOnNobody{"\0\0\0\0\x10", 5};
  return Frame(kPriority, kNone, stream, kOnNobody);
}

std::string WindowUpdate(std::uint32_t stream, std::uint32_t bytes) {
  return Frame(kWindowUpdate, kNone, stream, BytesOf(bytes, 4));
}

std::string Goaway(std::uint32_t code, std::uint32_t last_stream) {
  return Frame(kGoaway, kNone, 0, BytesOf(last_stream, 4) + BytesOf(code, 4));
}

std::string Times(std::size_t count, std::string_view text) {
  std::string all;
  all.reserve(count * text.size());
  for (std::size_t i = 0; i < count; ++i) all += text;
  return all;
}

std::uint32_t NumberOf(std::string_view bytes) {
  std::uint32_t number = 0;
  for (const char c : bytes) number = (number << 8U) | static_cast<unsigned char>(c);
  return number;
}

}  // namespace uplink::testing::http2
