#pragma once

#include <cstdint>
#include <utility>

#include "server/journal/gateway_use.h"

namespace uplink::journal {

/// What goes with all that one stream appends. A value.
struct AppendedBy {
  AppendedBy(std::uint64_t its_generation,  // NOLINT(google-explicit-constructor): without gateway
             GatewayRef its_gateway = nullptr)
      : generation(its_generation), gateway(std::move(its_gateway)) {}

  /// The client's when the stream began (RobotSessions::Begin).
  std::uint64_t generation;
  /// Which gateway the stream came through (Journal::GatewayOf).
  GatewayRef gateway;
};

}  // namespace uplink::journal
