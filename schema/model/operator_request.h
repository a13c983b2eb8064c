#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace uplink::model {

/// What a drone asks an operator to do. The numbers are what stores keep.
enum class OperatorRequestKind : std::uint8_t {
  kConfirmDeliveryReady = 0,
  kConfirmDeliveryComplete = 1,
};

/// `confirm_delivery_ready` or `confirm_delivery_complete`.
[[nodiscard]] std::string_view ToText(OperatorRequestKind kind);
/// The kind that ToText spells so, or nothing.
[[nodiscard]] std::optional<OperatorRequestKind> OperatorRequestKindFromText(std::string_view text);

/// A drone's request to an operator was opened or closed. (robot, request_id) is its key while it
/// is open. Durable. Made by uncrew::Records. A value.
struct OperatorRequest {
  /// When it was opened or closed: the drone's clock; 0: unknown.
  std::int64_t unix_time_ms = 0;
  /// Never empty; at most 128 bytes.
  std::string request_id;
  OperatorRequestKind kind = OperatorRequestKind::kConfirmDeliveryReady;
  /// At most 4,096 bytes.
  std::string text;
  /// Since when the drone waits, by its own clock; 0: unknown.
  std::int64_t requested_at_ms = 0;
  /// True when it opens, false when it was answered or withdrawn.
  bool open = false;

  friend bool operator==(const OperatorRequest&, const OperatorRequest&) = default;
};

}  // namespace uplink::model
