#include "tools/uplink-fleet/clients.h"

#include <algorithm>
#include <memory>

#include "schema/base/clock.h"
#ifdef UPLINK_WITH_GRPC
#include "tools/link/library_connection.h"
#endif

namespace uplink::synthetic {
namespace {

constexpr const char* kOwn = "own";
#ifdef UPLINK_WITH_GRPC
constexpr const char* kGrpc = "grpc";

/// The network of the library is the system's: it cannot be made slow or half-open from within.
bool TroublesTheNetwork(const Phase& phase) {
  return phase.trouble.delay > milliseconds(0) || phase.trouble.half_opens_per_minute > 0;
}
#endif

}  // namespace

#ifdef UPLINK_WITH_GRPC
std::vector<std::string> ClientNames() { return {kOwn, kGrpc}; }
std::vector<std::string> ProtocolNames() { return {kRelayProtocol, kDroneProtocol}; }

absl::Status UseClient(const std::string& name, SwarmOptions& swarm) {
  if (name != kGrpc) return absl::OkStatus();
  if (swarm.gateways > 0) {
    return absl::InvalidArgumentError("--client grpc: it has no --gateways");
  }
  if (std::ranges::any_of(swarm.scenario.phases, TroublesTheNetwork)) {
    return absl::InvalidArgumentError(
        "--client grpc: it has no scenario with delay or half_opens_per_minute");
  }
  swarm.dial = [](link::Loop& loop, const link::DialOptions& options, link::StreamEvents& events) {
    return std::make_unique<link::LibraryConnection>(loop, options, events);
  };
  return absl::OkStatus();
}
#else
std::vector<std::string> ClientNames() { return {kOwn}; }
std::vector<std::string> ProtocolNames() { return {kRelayProtocol}; }

absl::Status UseClient(const std::string& /*name*/, SwarmOptions& /*swarm*/) {
  return absl::OkStatus();
}
#endif

}  // namespace uplink::synthetic
