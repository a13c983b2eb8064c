#include "schema/model/ids.h"

#include <algorithm>
#include <cstring>

namespace uplink::model {
namespace {

std::optional<std::uint8_t> HexDigit(char digit) {
  if (digit >= '0' && digit <= '9') return static_cast<std::uint8_t>(digit - '0');
  if (digit >= 'a' && digit <= 'f') return static_cast<std::uint8_t>(digit - 'a' + 10);
  return std::nullopt;
}

}  // namespace

std::optional<SessionId> SessionId::FromBytes(std::string_view bytes) {
  if (bytes.size() != kBytes) return std::nullopt;
  SessionId id;
  std::memcpy(id.bytes_.data(), bytes.data(), kBytes);
  return id;
}

std::optional<SessionId> SessionId::FromHex(std::string_view hex) {
  if (hex.size() != 2 * kBytes) return std::nullopt;
  SessionId id;
  for (std::size_t i = 0; i < kBytes; ++i) {
    const auto high = HexDigit(hex[2 * i]);
    const auto low = HexDigit(hex[2 * i + 1]);
    if (!high || !low) return std::nullopt;
    id.bytes_[i] = static_cast<std::uint8_t>(*high * 16 + *low);
  }
  return id;
}

std::string SessionId::ToHex() const {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  text.reserve(2 * kBytes);
  for (const std::uint8_t byte : bytes_) {
    text += kDigits[byte >> 4U];
    text += kDigits[byte & 0xFU];
  }
  return text;
}

std::string_view SessionId::AsBytes() const {
  const void* data = bytes_.data();
  return {static_cast<const char*>(data), kBytes};
}

}  // namespace uplink::model
