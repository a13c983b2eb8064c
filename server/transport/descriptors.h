#pragma once

#include <cstddef>

#include "server/transport/options.h"

namespace uplink::transport {

/// Handshakes at once: each holds some 60 KiB and a place until its peer answers.
inline constexpr std::size_t kHandshakesMax = 512;
/// Connections that wait for their handshake.
inline constexpr std::size_t kHandshakesWaitingMax = 4'096;
/// Connections whose load balancer has not said where they come from, which it does at once.
inline constexpr std::size_t kProxyHeadersMax = 1'024;
/// Connections without a place whose peers may still read why.
inline constexpr std::size_t kLingersMax = 256;
/// Connections beyond one per stream: new ones that come before the old one has ended.
inline constexpr std::size_t kSpareConnections = 1'024;

/// Descriptors with which every bound of connections can be reached. With fewer, the listener
/// lowers its bounds. Pure.
[[nodiscard]] inline std::size_t DescriptorsWanted(const RelayOptions& options) {
  const std::size_t proxy_headers = options.proxy_protocol_from.empty() ? 0 : kProxyHeadersMax;
  return options.streams_max + kSpareConnections + kHandshakesMax + kHandshakesWaitingMax +
         proxy_headers + kLingersMax + options.descriptors_reserved;
}

}  // namespace uplink::transport
