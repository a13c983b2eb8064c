#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace uplink::model {

/// By which way a message came. The numbers are what stores keep.
enum class MessageSource : std::uint8_t {
  /// A robot's stream on the relay.
  kUplink = 0,
  /// A broker of a fleet that speaks Cyberwave.
  kCyberwave = 1,
  /// A call of a drone.
  kUncrew = 2,
};

/// Every source, in number order.
inline constexpr std::array kAllMessageSources = {MessageSource::kUplink, MessageSource::kCyberwave,
                                                  MessageSource::kUncrew};

/// `uplink`, `cyberwave` or `uncrew`.
[[nodiscard]] std::string_view ToText(MessageSource source);
/// The source that ToText spells so, or nothing.
[[nodiscard]] std::optional<MessageSource> MessageSourceFromText(std::string_view text);

}  // namespace uplink::model
