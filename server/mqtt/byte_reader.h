#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace uplink::mqtt {

/// Reads MQTT's numbers and fields from bytes, never past their end: an incomplete one yields
/// nothing and takes nothing. Confined to its function.
class ByteReader final {
 public:
  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}

  [[nodiscard]] std::string_view rest() const { return rest_; }
  [[nodiscard]] bool empty() const { return rest_.empty(); }

  [[nodiscard]] std::optional<std::string_view> Bytes(std::size_t count) {
    if (count > rest_.size()) return std::nullopt;
    const std::string_view bytes = rest_.substr(0, count);
    rest_.remove_prefix(count);
    return bytes;
  }
  /// A big-endian number of `kBytes` bytes.
  template <std::size_t kBytes>
  [[nodiscard]] std::optional<std::uint32_t> Number() {
    static_assert(kBytes <= sizeof(std::uint32_t));
    const auto bytes = Bytes(kBytes);
    if (!bytes) return std::nullopt;
    std::uint32_t number = 0;
    for (const char each : *bytes) number = number << 8U | static_cast<unsigned char>(each);
    return number;
  }
  /// A length of at most four digits of seven bits, the lowest first.
  [[nodiscard]] std::optional<std::uint32_t> Length() {
    constexpr std::size_t kDigitsMax = 4;
    std::uint32_t length = 0;
    for (std::size_t digit = 0; digit < kDigitsMax && digit < rest_.size(); ++digit) {
      const auto byte = static_cast<unsigned char>(rest_[digit]);
      length |= (byte & 0x7FU) << (7U * digit);
      if ((byte & 0x80U) == 0) {
        rest_.remove_prefix(digit + 1);
        return length;
      }
    }
    return std::nullopt;
  }
  /// A field after its 16-bit length.
  [[nodiscard]] std::optional<std::string_view> Field() {
    ByteReader ahead(rest_);
    const auto length = ahead.Number<2>();
    if (!length) return std::nullopt;
    const auto field = ahead.Bytes(*length);
    if (field) rest_ = ahead.rest_;
    return field;
  }

 private:
  std::string_view rest_;
};

}  // namespace uplink::mqtt
