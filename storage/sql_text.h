#pragma once

#include <array>
#include <cstddef>
#include <initializer_list>
#include <string_view>

namespace uplink::storage {

/// The text of a statement, put together by the compiler: as a constant it costs nothing at run
/// time, and lives as long as a statement needs it. A text that is too long does not compile.
class SqlText final {
 public:
  static constexpr std::size_t kBytesMax = 4096;

  constexpr SqlText() = default;
  constexpr SqlText(std::initializer_list<std::string_view> parts) { Add(parts); }

  constexpr void Add(std::string_view text) {
    for (const char letter : text) bytes_.at(size_++) = letter;
  }
  constexpr void Add(std::initializer_list<std::string_view> parts) {
    for (const std::string_view part : parts) Add(part);
  }
  /// A parameter as PostgreSQL has it, from 1 on, with its type: `$3::bigint[]`.
  constexpr void AddParameter(std::size_t number, std::string_view type) {
    Add("$");
    if (number >= 10) AddDigit(number / 10);
    AddDigit(number % 10);
    Add({"::", type});
  }

  [[nodiscard]] constexpr std::string_view view() const { return {bytes_.data(), size_}; }

 private:
  constexpr void AddDigit(std::size_t digit) {
    bytes_.at(size_++) = static_cast<char>('0' + static_cast<int>(digit));
  }

  std::array<char, kBytesMax> bytes_{};
  std::size_t size_ = 0;
};

}  // namespace uplink::storage
