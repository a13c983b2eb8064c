#pragma once

#include <array>
#include <chrono>
#include <cstddef>

#include "schema/base/clock.h"
#include "server/config/config.h"
#include "server/http/listeners.h"

namespace uplink::http {

/// What one listener holds and waits for. A value.
struct ListenerLimits {
  /// Over kMonitoringPlaces.
  std::size_t connections_max = 0;
  /// Of these, what one source has at most; 0: all. Where it is set, a connection ends with its
  /// answer while over half of all, or of its source's, are taken.
  std::size_t source_share = 0;
  /// Bytes of a request's line and headers together, and of a body, which is read and not looked
  /// at. Of what a client sends ahead of its answers we hold so much together; the rest waits in
  /// the kernel. One request of a connection is under way at most.
  std::size_t header_bytes_max = 0;
  std::size_t body_bytes_max = 0;
  /// How long a request may take from its first byte to its last, and the peer to take an answer.
  milliseconds request_wait{0};
  milliseconds answer_wait{0};
  /// How long a connection is kept without a request. Answers tell it as Keep-Alive; proxies that
  /// keep theirs for 60 s (nginx's upstream, AWS's load balancers) end them first.
  milliseconds idle_wait{0};
};

/// Of listen.http, whose connections_max is http.connections_max.
inline constexpr ListenerLimits kHttpLimits{.header_bytes_max = 16UL * 1024,
                                            .body_bytes_max = 16UL * 1024,
                                            .request_wait = std::chrono::seconds(30),
                                            .answer_wait = std::chrono::seconds(30),
                                            .idle_wait = std::chrono::seconds(75)};

/// Of listen.metrics, which strangers may reach. One source has a quarter at most, so that a client
/// that asks without a pause leaves room for others. Their requests are short; a large answer over
/// a slow line is not.
inline constexpr ListenerLimits kMetricsLimits{.connections_max = config::kMetricsConnectionsMax,
                                               .source_share = 8,
                                               .header_bytes_max = 8UL * 1024,
                                               .body_bytes_max = 1024,
                                               .request_wait = std::chrono::seconds(10),
                                               .answer_wait = std::chrono::seconds(30),
                                               .idle_wait = std::chrono::seconds(75)};

/// Every 503 names it as Retry-After: a busy moment has passed then, and a store that is away is
/// not asked more often than it is tried.
inline constexpr std::chrono::seconds kRetryAfter{2};

/// Connections that each listener holds at most, by ListenerId; 0: there is no such listener.
using ConnectionsMax = std::array<std::size_t, kListenerKeys.size()>;

/// Connections that are accepted in one turn of the loop, and at most half of all places, or of a
/// source's share, so that each is read before it could give way to the next ones.
inline constexpr std::size_t kAcceptsPerTurn = 16;
/// How long the listener rests after a failed accept (no descriptors).
inline constexpr std::chrono::milliseconds kAcceptPause{100};

}  // namespace uplink::http
