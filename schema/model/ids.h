#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace uplink::model {

/// Position of a message in its session: 1 to kSeqMax; 0 means none.
using Seq = std::uint64_t;

/// Highest number of the contract; one more would not fit the store's signed 64-bit columns.
inline constexpr Seq kSeqMax = 0x7FFF'FFFF'FFFF'FFFFULL;

/// Bytes of the longest RURI and agent version (protocol: texts in frames).
inline constexpr std::size_t kRuriBytesMax = 256;
inline constexpr std::size_t kAgentVersionBytesMax = 256;
/// Bytes of the longest Reject.detail and Notice.detail.
inline constexpr std::size_t kDetailBytesMax = 512;

/// One numbering of messages by an agent: 16 random bytes, drawn when it starts at 1. A value.
class SessionId {
 public:
  static constexpr std::size_t kBytes = 16;

  SessionId() = default;
  explicit SessionId(const std::array<std::uint8_t, kBytes>& bytes) : bytes_(bytes) {}

  /// Nothing if `bytes` is not exactly 16 long.
  [[nodiscard]] static std::optional<SessionId> FromBytes(std::string_view bytes);
  /// 32 lower-case hex digits.
  [[nodiscard]] static std::optional<SessionId> FromHex(std::string_view hex);

  [[nodiscard]] std::string ToHex() const;
  [[nodiscard]] std::string_view AsBytes() const;
  [[nodiscard]] const std::array<std::uint8_t, kBytes>& bytes() const { return bytes_; }

  friend auto operator<=>(const SessionId&, const SessionId&) = default;

 private:
  std::array<std::uint8_t, kBytes> bytes_{};
};

/// Who a robot is: its RURI and the fleet that owns it, both from its certificate. A value.
struct RobotId {
  std::string ruri;
  std::string fleet;

  friend auto operator<=>(const RobotId&, const RobotId&) = default;
};

}  // namespace uplink::model

template <>
struct std::hash<uplink::model::SessionId> {
  std::size_t operator()(const uplink::model::SessionId& id) const noexcept {
    return std::hash<std::string_view>{}(id.AsBytes());
  }
};
