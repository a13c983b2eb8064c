#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace uplink::transport {

/// Why a connection was ended before it had a stream, or for what its peer did to us. Closed.
enum class TurnedAway : std::uint8_t {
  /// No place for one more connection that has shown its certificate.
  kFull,
  /// Too many waited for their handshake.
  kCrowded,
  /// Its handshake took long while others waited, and its source had the most.
  kGaveWay,
  /// The peer did not go on with the handshake.
  kHandshakeTimeout,
  /// It speaks no TLS.
  kNoTls,
  /// It offers no version, no suite or no protocol that we take.
  kNothingShared,
  kNoCertificate,
  /// No authority of ours signed its certificate.
  kUntrusted,
  kHandshakeError,
  /// Its certificate has more connections than it may.
  kKey,
  /// It opened no stream in time, or left without one.
  kNoStream,
  /// Bytes that are no HTTP/2, or break its rules.
  kProtocol,
  kPings,
  kPongs,
  kResets,
  kSettings,
  kEmptyData,
  kPriorities,
  kWindowUpdates,
  kUnknownFrames,
  kHeaders,
  kContinuations,
  kKeyUpdates,
  /// It did not read what we had for it.
  kNotRead,
  /// It was not heard for long, and did not answer when it was asked.
  kSilent,
  /// It came through a load balancer, without the header that says from where.
  kProxyHeader,
  /// It shows certificates that are not looked into: too many or too large ones, a kind of key that
  /// is not taken.
  kCertificate,
};

/// As metric labels and in logs.
inline constexpr std::array<std::string_view, 27> kTurnedAwayTexts = {"full",
                                                                      "crowded",
                                                                      "gave_way",
                                                                      "handshake_timeout",
                                                                      "no_tls",
                                                                      "nothing_shared",
                                                                      "no_certificate",
                                                                      "untrusted",
                                                                      "handshake_error",
                                                                      "key",
                                                                      "no_stream",
                                                                      "protocol",
                                                                      "pings",
                                                                      "pongs",
                                                                      "resets",
                                                                      "settings",
                                                                      "empty_data",
                                                                      "priorities",
                                                                      "window_updates",
                                                                      "unknown_frames",
                                                                      "headers",
                                                                      "continuations",
                                                                      "key_updates",
                                                                      "not_read",
                                                                      "silent",
                                                                      "proxy_header",
                                                                      "certificate"};
static_assert(kTurnedAwayTexts.size() == static_cast<std::size_t>(TurnedAway::kCertificate) + 1);

}  // namespace uplink::transport
