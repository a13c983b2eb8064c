#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace uplink::model::cyberwave {

/// The id of a twin, an environment or a workflow run: 16 bytes, written as 8-4-4-4-12 hex digits
/// (RFC 9562). A value.
class Uuid {
 public:
  static constexpr std::size_t kBytes = 16;
  static constexpr std::size_t kTextBytes = 36;

  Uuid() = default;

  /// Digits of any case; nothing for a text of another form.
  [[nodiscard]] static std::optional<Uuid> FromText(std::string_view text);

  /// In lower case.
  [[nodiscard]] std::string ToText() const;
  [[nodiscard]] const std::array<std::uint8_t, kBytes>& bytes() const { return bytes_; }

  friend auto operator<=>(const Uuid&, const Uuid&) = default;

 private:
  std::array<std::uint8_t, kBytes> bytes_{};
};

}  // namespace uplink::model::cyberwave

template <>
struct std::hash<uplink::model::cyberwave::Uuid> {
  std::size_t operator()(const uplink::model::cyberwave::Uuid& id) const noexcept {
    const void* data = id.bytes().data();
    return std::hash<std::string_view>{}({static_cast<const char*>(data), id.bytes().size()});
  }
};
