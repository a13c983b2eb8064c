#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "schema/base/clock.h"
#include "server/front/limits.h"

namespace uplink::front {

/// Frames of HTTP/2, and messages of TLS, that cost their sender nearly nothing, and us something
/// each.
enum class FrameKind : std::uint8_t {
  /// RST_STREAM: a stream that was opened to be dropped (CVE-2023-44487, "rapid reset"), or that we
  /// dropped for what its peer did (CVE-2025-8671, "made you reset").
  kReset,
  kPing,
  /// An answer to a PING that was not sent.
  kPong,
  kSettings,
  /// DATA without a byte of content, padded or not.
  kEmptyData,
  kPriority,
  kWindowUpdate,
  /// Of a type that HTTP/2 does not know.
  kUnknown,
  kHeaders,
  /// A further piece of a list of headers: no list that we take needs one.
  kContinuation,
  /// A message of TLS's handshake after the handshake: new keys, mostly.
  kKeyUpdate,
};
inline constexpr std::size_t kFrameKinds = 11;

/// What a limit is for: one stream costs some frames, so that a peer with many may send more.
enum class FrameScope : std::uint8_t { kConnection, kStreams };

/// How many of a kind may come. A value.
struct FrameLimit {
  FrameKind kind = FrameKind::kReset;
  /// Frames per second.
  std::uint32_t rate = 0;
  /// Frames at once, after a pause; with FrameScope::kStreams of a connection that may have
  /// kRobotStreamsMax, and of others in proportion.
  std::uint32_t burst = 0;
  FrameScope scope = FrameScope::kConnection;
  /// The kind's value of a metric's label.
  std::string_view label;
};

/// By kind.
inline constexpr std::array<FrameLimit, kFrameKinds> kFrameLimits{{
    {FrameKind::kReset, 20, 100, FrameScope::kStreams, "reset"},
    {FrameKind::kPing, 100, 100, FrameScope::kConnection, "ping"},
    {FrameKind::kPong, 5, 20, FrameScope::kConnection, "pong"},
    {FrameKind::kSettings, 5, 20, FrameScope::kConnection, "settings"},
    {FrameKind::kEmptyData, 50, 100, FrameScope::kStreams, "empty_data"},
    {FrameKind::kPriority, 100, 200, FrameScope::kStreams, "priority"},
    {FrameKind::kWindowUpdate, 2000, 4000, FrameScope::kStreams, "window_update"},
    {FrameKind::kUnknown, 50, 100, FrameScope::kConnection, "unknown"},
    {FrameKind::kHeaders, 200, 400, FrameScope::kStreams, "headers"},
    // Below the number with which nghttp2 ends a session for a rule that was broken.
    {FrameKind::kContinuation, 5, 7, FrameScope::kConnection, "continuation"},
    {FrameKind::kKeyUpdate, 1, 20, FrameScope::kConnection, "key_update"},
}};

[[nodiscard]] constexpr const FrameLimit& LimitOf(FrameKind kind) {
  return kFrameLimits[static_cast<std::size_t>(kind)];
}

/// How many frames of each kind a connection's peer may still send (GCRA: per kind the one time at
/// which all of its burst is there again). Allocates nothing. Confined to the connection's thread.
class FrameRates final {
 public:
  /// For a peer that may have so many streams; until TLS has shown which one, a robot's.
  explicit FrameRates(std::uint32_t streams_max = kRobotStreamsMax) : streams_max_(streams_max) {}

  /// Whether a frame that came now is within its kind's limit; one that is not costs nothing.
  [[nodiscard]] bool Take(FrameKind kind, SteadyTime now);

 private:
  std::uint32_t streams_max_;
  std::array<SteadyTime, kFrameKinds> full_at_{};
};

/// Each of 10,000 connections has one.
static_assert(sizeof(FrameRates) <= 96);

}  // namespace uplink::front
