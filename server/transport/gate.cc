#include "server/transport/gate.h"

#include <algorithm>

#include <fmt/format.h>

namespace uplink::transport {

Entrant EntrantOf(const identity::PeerIdentity& peer) {
  switch (peer.role) {
    case identity::Role::kRobot:
      return {.robot = peer.ruri};
    case identity::Role::kGateway:
      return {.gateway = peer.gateway.subject};
    case identity::Role::kViewer:
    case identity::Role::kOperator:
    case identity::Role::kAdmin:
      break;
  }
  return {};
}

Gate::Gate(const Limits& limits, RelayProbe& probe)
    : streams_max_(limits.streams_max),
      per_gateway_max_(std::clamp<std::size_t>(
          limits.streams_max * kGatewayStreamsPercent / 100, 1,
          std::max<std::size_t>(1, kGatewayFullConnections * limits.gateway_streams_max))),
      probe_(probe) {}

absl::Status Gate::CheckRobot(const std::string& robot) const {
  const std::size_t has = by_robot_.Of(robot);
  if (has < kStreamsPerCertificateMax) return absl::OkStatus();
  probe_.refused_robot_total.Add();
  return absl::ResourceExhaustedError(
      fmt::format("the server admits no more streams of this certificate: it has {}", has));
}

absl::Status Gate::CheckGateway(const std::string& gateway) const {
  const std::size_t has = by_gateway_.Of(gateway);
  if (has < per_gateway_max_) return absl::OkStatus();
  probe_.refused_gateway_total.Add();
  return absl::ResourceExhaustedError(fmt::format(
      "the server admits no more streams of gateway {}: it has {} (limits.gateway_streams_max, "
      "limits.robots_max)",
      gateway, has));
}

absl::Status Gate::Enter(const Entrant& entrant) {
  const std::lock_guard lock(mutex_);
  if (closed_) {
    probe_.refused_draining_total.Add();
    return absl::UnavailableError("the server drains");
  }
  if (streams_ >= streams_max_) {
    probe_.refused_full_total.Add();
    return absl::ResourceExhaustedError(
        fmt::format("the server admits no more streams: it has {}", streams_));
  }
  if (absl::Status status = CheckRobot(entrant.robot); !status.ok()) return status;
  if (absl::Status status = CheckGateway(entrant.gateway); !status.ok()) return status;
  ++streams_;
  if (!entrant.robot.empty()) by_robot_.Add(entrant.robot);
  if (!entrant.gateway.empty()) {
    by_gateway_.Add(entrant.gateway);
    probe_.gateway_streams.Add();
  }
  return absl::OkStatus();
}

void Gate::Leave(const Entrant& entrant) {
  const std::lock_guard lock(mutex_);
  --streams_;
  if (!entrant.robot.empty()) by_robot_.Drop(entrant.robot);
  if (!entrant.gateway.empty()) {
    by_gateway_.Drop(entrant.gateway);
    probe_.gateway_streams.Add(-1);
  }
  if (streams_ == 0) empty_.notify_all();
}

void Gate::Close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
}

bool Gate::closed() const {
  const std::lock_guard lock(mutex_);
  return closed_;
}

std::size_t Gate::streams() const {
  const std::lock_guard lock(mutex_);
  return streams_;
}

bool Gate::WaitEmpty(milliseconds wait) const {
  std::unique_lock lock(mutex_);
  return empty_.wait_for(lock, wait, [this] { return streams_ == 0; });
}

}  // namespace uplink::transport
