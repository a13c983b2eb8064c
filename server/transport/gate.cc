#include "server/transport/gate.h"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

namespace uplink::transport {
namespace {

constexpr std::size_t IndexOf(Admission admission) { return static_cast<std::size_t>(admission); }

constexpr std::string_view WordOf(Admission admission) {
  switch (admission) {
    case Admission::kStream:
      return "streams";
    case Admission::kCall:
      return "calls";
    case Admission::kHealth:
      return "health checks";
  }
  return "";
}

constexpr std::size_t CallsMax(const Gate::Limits& limits) {
  return std::max(limits.streams_max, kCallsMaxAtLeast);
}

constexpr std::size_t PerGateway(std::size_t all_max, const Gate::Limits& limits) {
  const std::size_t own =
      std::max<std::size_t>(1, kGatewayFullConnections * limits.gateway_streams_max);
  return std::clamp<std::size_t>(all_max * kGatewayStreamsPercent / 100, 1, own);
}

}  // namespace

Entrant EntrantOf(const identity::PeerIdentity& peer) {
  switch (peer.role) {
    case identity::Role::kRobot:
      return {.robot = peer.ruri};
    case identity::Role::kGateway:
      return {.gateway = peer.gateway.subject};
    case identity::Role::kViewer:
    case identity::Role::kOperator:
    case identity::Role::kAdmin:
    case identity::Role::kMetrics:
      break;
  }
  return {};
}

Gate::Gate(const Limits& limits, RelayProbe& probe)
    : probe_(probe),
      here_{
          Here{.max = limits.streams_max,
               .per_gateway_max = PerGateway(limits.streams_max, limits)},
          Here{.max = CallsMax(limits), .per_gateway_max = PerGateway(CallsMax(limits), limits)},
          Here{.max = CallsMax(limits), .per_gateway_max = PerGateway(CallsMax(limits), limits)}} {}

absl::Status Gate::CheckRobot(const std::string& robot, Admission admission) const {
  const std::size_t has = here_[IndexOf(admission)].by_robot.Of(robot);
  if (has <
      (admission == Admission::kStream ? kStreamsPerCertificateMax : kCallsPerCertificateMax)) {
    return absl::OkStatus();
  }
  probe_.refused_robot_total.Add();
  return absl::ResourceExhaustedError(fmt::format(
      "the server admits no more {} of this certificate: it has {}", WordOf(admission), has));
}

absl::Status Gate::CheckGateway(const std::string& gateway, Admission admission) const {
  const std::size_t has = here_[IndexOf(admission)].by_gateway.Of(gateway);
  if (has < here_[IndexOf(admission)].per_gateway_max) return absl::OkStatus();
  probe_.refused_gateway_total.Add();
  return absl::ResourceExhaustedError(fmt::format(
      "the server admits no more {} of gateway {}: it has {} (limits.gateway_streams_max, "
      "limits.robots_max)",
      WordOf(admission), gateway, has));
}

absl::Status Gate::Enter(const Entrant& entrant, Admission admission) {
  const std::lock_guard lock(mutex_);
  if (closed_) {
    probe_.refused_draining_total.Add();
    return absl::UnavailableError("the server drains");
  }
  Here& here = here_[IndexOf(admission)];
  if (here.all >= here.max) {
    probe_.refused_full_total.Add();
    return absl::ResourceExhaustedError(
        fmt::format("the server admits no more {}: it has {}", WordOf(admission), here.all));
  }
  if (absl::Status status = CheckRobot(entrant.robot, admission); !status.ok()) return status;
  if (absl::Status status = CheckGateway(entrant.gateway, admission); !status.ok()) return status;
  ++here.all;
  if (!entrant.robot.empty()) here.by_robot.Add(entrant.robot);
  if (!entrant.gateway.empty()) {
    here.by_gateway.Add(entrant.gateway);
    if (admission == Admission::kStream) probe_.gateway_streams.Add();
  }
  return absl::OkStatus();
}

void Gate::Leave(const Entrant& entrant, Admission admission) {
  const std::lock_guard lock(mutex_);
  Here& here = here_[IndexOf(admission)];
  --here.all;
  if (!entrant.robot.empty()) here.by_robot.Drop(entrant.robot);
  if (!entrant.gateway.empty()) {
    here.by_gateway.Drop(entrant.gateway);
    if (admission == Admission::kStream) probe_.gateway_streams.Add(-1);
  }
  if (All() == 0) empty_.notify_all();
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
  return All();
}

bool Gate::WaitEmpty(milliseconds wait) const {
  std::unique_lock lock(mutex_);
  return empty_.wait_for(lock, wait, [this] { return All() == 0; });
}

}  // namespace uplink::transport
