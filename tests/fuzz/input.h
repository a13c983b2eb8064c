#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace uplink::fuzz {

/// Reads an input piece by piece. Bytes that are missing at the end read as 0.
class Input final {
 public:
  Input(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

  [[nodiscard]] bool more() const { return at_ < size_; }
  std::uint8_t Byte() { return more() ? data_[at_++] : std::uint8_t{0}; }
  /// Two bytes, low first.
  std::uint16_t Word() {
    const std::uint8_t low = Byte();
    return static_cast<std::uint16_t>(low + (Byte() << 8U));
  }
  std::string Bytes(std::size_t count) {
    std::string bytes;
    for (; count > 0 && more(); --count) bytes += static_cast<char>(Byte());
    return bytes;
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
  std::size_t at_ = 0;
};

}  // namespace uplink::fuzz
