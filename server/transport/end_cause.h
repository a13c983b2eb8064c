#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include <absl/status/status.h>

#include "schema/model/connection.h"

namespace uplink::transport {

/// What ended a robot's connection, as the part of the server that ended or lost it knows. Closed.
enum class EndCause : std::uint8_t {
  /// The agent half-closed its stream; a drone closed its connection between two calls; a twin's
  /// client said `disconnected`.
  kClosed,
  /// The agent reset the stream.
  kReset,
  /// The TCP connection ended, or TLS did.
  kCut,
  /// No answer to our keepalive, or not even TCP acknowledged what we sent.
  kUnanswered,
  /// A newer stream of the robot took over, or another server has the robot.
  kSuperseded,
  kDrain,
  /// limits.connection_age_max, or its certificate expires soon.
  kAge,
  /// Its certificate has expired.
  kExpired,
  /// The agent did not read.
  kNotRead,
  /// It broke a rule of our protocol, of gRPC or of HTTP/2.
  kBrokeRules,
  /// A bound of the server: places, sessions, connections of one certificate, memory.
  kBound,
  /// limits.unconfirmed_rejects_max.
  kUnconfirmed,
  /// Its certificate may not speak for the robot any more.
  kNotAllowed,
  /// An operator forgets the robot.
  kForgotten,
  /// An operator blocked the robot.
  kBlocked,
  /// An operator asked that it ends; the robot may come again.
  kDisconnected,
  /// The store lost what it had of the robot.
  kStoreLost,
  /// The server ended without a drain.
  kServerStops,
};

/// Every cause, in number order.
inline constexpr std::array kAllEndCauses = {
    EndCause::kClosed,     EndCause::kReset,       EndCause::kCut,     EndCause::kUnanswered,
    EndCause::kSuperseded, EndCause::kDrain,       EndCause::kAge,     EndCause::kExpired,
    EndCause::kNotRead,    EndCause::kBrokeRules,  EndCause::kBound,   EndCause::kUnconfirmed,
    EndCause::kNotAllowed, EndCause::kForgotten,   EndCause::kBlocked, EndCause::kDisconnected,
    EndCause::kStoreLost,  EndCause::kServerStops,
};

/// The reason that lists of connections show. Pure.
[[nodiscard]] model::ConnectionEnd WhyOf(EndCause cause);
/// A sentence for a person, where no status says more. Pure.
[[nodiscard]] std::string_view SentenceOf(EndCause cause);

/// The end of a call or connection. A value; the text is valid during the call that passes it.
struct Ending {
  EndCause cause = EndCause::kCut;
  /// What the peer's reset meant, or the status with which the transport ends the call; empty if
  /// the connection is gone.
  std::optional<absl::StatusCode> code = {};
  /// One sentence; empty: that of the cause.
  std::string_view detail = {};
};

/// The end of what ends with this status, which outlives it.
[[nodiscard]] inline Ending EndingWith(EndCause cause, const absl::Status& status) {
  const auto message = status.message();
  return {.cause = cause, .code = status.code(), .detail = {message.data(), message.size()}};
}

}  // namespace uplink::transport
