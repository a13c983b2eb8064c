#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "schema/base/clock.h"

namespace uplink::front {

/// Frames of HTTP/2, and messages of TLS, that cost their sender nearly nothing, and us something
/// each.
enum class FrameKind : std::uint8_t {
  /// RST_STREAM: a stream that was opened to be dropped (CVE-2023-44487, "rapid reset").
  kReset,
  kPing,
  kSettings,
  /// DATA without a byte of content.
  kEmptyData,
  kPriority,
  kWindowUpdate,
  /// Of a type that HTTP/2 does not know.
  kUnknown,
  kHeaders,
  /// A message of TLS's handshake after the handshake: new keys, mostly.
  kKeyUpdate,
};
inline constexpr std::size_t kFrameKinds = 9;

/// How many of a kind may come. A value.
struct FrameLimit {
  FrameKind kind = FrameKind::kReset;
  /// Frames per second.
  std::uint32_t rate = 0;
  /// Frames at once, after a pause.
  std::uint32_t burst = 0;
  /// The kind's value of a metric's label.
  std::string_view label;
};

/// By kind.
inline constexpr std::array<FrameLimit, kFrameKinds> kFrameLimits{{
    {FrameKind::kReset, 20, 100, "reset"},
    {FrameKind::kPing, 100, 100, "ping"},
    {FrameKind::kSettings, 5, 20, "settings"},
    {FrameKind::kEmptyData, 50, 100, "empty_data"},
    {FrameKind::kPriority, 100, 200, "priority"},
    {FrameKind::kWindowUpdate, 2000, 4000, "window_update"},
    {FrameKind::kUnknown, 50, 100, "unknown"},
    {FrameKind::kHeaders, 200, 400, "headers"},
    {FrameKind::kKeyUpdate, 1, 20, "key_update"},
}};

[[nodiscard]] constexpr const FrameLimit& LimitOf(FrameKind kind) {
  return kFrameLimits[static_cast<std::size_t>(kind)];
}

/// How many frames of each kind a connection's peer may still send (GCRA: per kind the one time at
/// which all of its burst is there again). Allocates nothing. Confined to the connection's thread.
class FrameRates final {
 public:
  /// Whether a frame that came now is within its kind's limit; one that is not costs nothing.
  [[nodiscard]] bool Take(FrameKind kind, SteadyTime now);

 private:
  std::array<SteadyTime, kFrameKinds> full_at_{};
};

/// Each of 10,000 connections has one.
static_assert(sizeof(FrameRates) <= 72);

}  // namespace uplink::front
