#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace uplink::transport {

/// Why we ended a connection before it had a stream, or for its peer's behaviour. A closed list.
enum class TurnedAway : std::uint8_t {
  /// No place for one more connection that has shown its certificate.
  kFull,
  /// Too many waited for their handshake.
  kCrowded,
  /// Its handshake took long while others waited, and its source had the most.
  kGaveWay,
  /// The peer did not go on with the handshake.
  kHandshakeTimeout,
  /// It does not speak TLS.
  kNoTls,
  /// It offers no version, suite or protocol that we accept.
  kNothingShared,
  kNoCertificate,
  /// No authority of ours signed its certificate.
  kUntrusted,
  kHandshakeError,
  /// Its certificate has more connections than it may.
  kKey,
  /// It opened no stream in time, or left without one.
  kNoStream,
  /// It sent bytes that are not HTTP/2, or break its rules.
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
  /// It did not read what we sent.
  kNotRead,
  /// It was silent for long, and did not answer our ping.
  kSilent,
  /// It came through a load balancer, without a valid PROXY header in time.
  kProxyHeader,
  /// Its certificates are not examined: too many, too large, or with a kind of key that we do not
  /// accept.
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

/// What became of a certificate that may not come in. Closed.
enum class Denied : std::uint8_t {
  /// A new connection showed one that is revoked.
  kRevoked,
  /// It was revoked, and its connection was ended.
  kEnded,
  /// It is not what its authority may vouch for.
  kAuthority,
};

/// As metric labels.
inline constexpr std::array<std::string_view, 3> kDeniedTexts = {"revoked", "ended", "authority"};

}  // namespace uplink::transport
