#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "schema/base/clock.h"
#include "server/front/http2/limits.h"
#include "server/transport/turned_away.h"

namespace uplink::front {

/// Frames of HTTP/2, and messages of TLS, that cost their sender almost nothing, but us something
/// each.
enum class FrameKind : std::uint8_t {
  /// RST_STREAM: a stream that was opened to be dropped (CVE-2023-44487, "rapid reset"), or that we
  /// dropped for its peer's fault (CVE-2025-8671, "made you reset").
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
  /// A further piece of a header list: no list that we accept needs one.
  kContinuation,
  /// A message of TLS's handshake after the handshake: new keys, mostly.
  kKeyUpdate,
};
inline constexpr std::size_t kFrameKinds = 11;

/// What a limit scales with: each stream, and each unary call, needs some frames, so a peer with
/// many may send more.
enum class FrameScope : std::uint8_t { kConnection, kStreams, kCalls };

/// How many of a kind may come. A value.
struct FrameLimit {
  FrameKind kind = FrameKind::kReset;
  /// Frames per second. With FrameScope::kConnection one more for each stream past kRobotStreamsMax
  /// that the connection may have, since an agent opens its stream once a second at most. With
  /// kCalls one more for each extra call per second.
  std::uint32_t rate = 0;
  /// Frames at once, after a pause. With FrameScope::kConnection it holds for a connection with
  /// kRobotStreamsMax, and scales for others.
  std::uint32_t burst = 0;
  FrameScope scope = FrameScope::kConnection;
  /// Further frames for each HEADERS or DATA frame of ours: clients answer what we send.
  std::uint16_t per_sent = 0;
  /// What too many of them count as.
  transport::TurnedAway cause = transport::TurnedAway::kProtocol;
  /// The kind's value of a metric's label.
  std::string_view label;
};

/// By kind. Clients answer our frames by PING and WINDOW_UPDATE alone (per_sent). SETTINGS follow
/// the bandwidth that a client measures, which doubles a dozen times at most.
inline constexpr std::array<FrameLimit, kFrameKinds> kFrameLimits{{
    {FrameKind::kReset, 20, 100, FrameScope::kStreams, 0, transport::TurnedAway::kResets, "reset"},
    // Source: bdp_estimator.go of grpc-go, which measures the bandwidth by a PING after DATA.
    {FrameKind::kPing, 100, 100, FrameScope::kConnection, 1, transport::TurnedAway::kPings, "ping"},
    {FrameKind::kPong, 5, 20, FrameScope::kConnection, 0, transport::TurnedAway::kPongs, "pong"},
    {FrameKind::kSettings, 5, 20, FrameScope::kConnection, 0, transport::TurnedAway::kSettings,
     "settings"},
    {FrameKind::kEmptyData, 50, 100, FrameScope::kStreams, 0, transport::TurnedAway::kEmptyData,
     "empty_data"},
    {FrameKind::kPriority, 100, 200, FrameScope::kStreams, 0, transport::TurnedAway::kPriorities,
     "priority"},
    // A client may open the stream's window and the connection's for each DATA.
    {FrameKind::kWindowUpdate, 2000, 4000, FrameScope::kStreams, 2,
     transport::TurnedAway::kWindowUpdates, "window_update"},
    {FrameKind::kUnknown, 50, 100, FrameScope::kConnection, 0,
     transport::TurnedAway::kUnknownFrames, "unknown"},
    {FrameKind::kHeaders, 200, 400, FrameScope::kCalls, 0, transport::TurnedAway::kHeaders,
     "headers"},
    // Below the number with which nghttp2 ends a session for a rule that was broken.
    {FrameKind::kContinuation, 5, 7, FrameScope::kConnection, 0,
     transport::TurnedAway::kContinuations, "continuation"},
    {FrameKind::kKeyUpdate, 1, 20, FrameScope::kConnection, 0, transport::TurnedAway::kKeyUpdates,
     "key_update"},
}};

[[nodiscard]] constexpr const FrameLimit& LimitOf(FrameKind kind) {
  return kFrameLimits[static_cast<std::size_t>(kind)];
}

/// Outstanding answers of a kind to frames that we sent: as many as a slow network has under way.
inline constexpr std::uint16_t kForSentMax = 4'000;
/// Once we have sent nothing for this long, no answer is outstanding: a client answers sooner.
inline constexpr std::chrono::seconds kForSentWait{8};

/// How many frames of each kind a connection's peer may still send, and how many more as answers to
/// ours. The first is GCRA: per kind it keeps the time at which the whole burst is free again, in
/// whole intervals and half the memory of a limits::TokenBucket, since each connection has them.
/// Allocates nothing. Confined to the connection's thread.
class FrameRates final {
 public:
  /// For a peer that may have so many streams, and calls per second. Until TLS has shown the peer,
  /// a robot's numbers hold.
  explicit FrameRates(std::uint32_t streams_max = kRobotStreamsMax,
                      std::uint32_t calls_per_second = 0)
      : streams_max_(streams_max), calls_per_second_(calls_per_second) {}

  /// We sent a HEADERS or DATA frame: the peer may answer it.
  void NoteSent(SteadyTime now);
  /// Whether a frame that came now counts as the answer to one of ours. If so, do not call Take for
  /// it.
  [[nodiscard]] bool TakeForSent(FrameKind kind, SteadyTime now);
  /// Whether a frame that came now is within its kind's limit; a frame past it takes nothing.
  [[nodiscard]] bool Take(FrameKind kind, SteadyTime now);

 private:
  [[nodiscard]] std::uint32_t RateOf(const FrameLimit& limit) const;

  std::uint32_t streams_max_;
  std::uint32_t calls_per_second_;
  /// By kind: answers outstanding, which NoteSent adds and TakeForSent takes.
  std::array<std::uint16_t, kFrameKinds> for_sent_{};
  SteadyTime sent_at_;
  std::array<SteadyTime, kFrameKinds> full_at_{};
};

/// Each of 10,000 connections has one.
static_assert(sizeof(FrameRates) <= 128);

}  // namespace uplink::front
