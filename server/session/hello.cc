#include "server/session/hello.h"

#include <string>
#include <utility>

#include <fmt/format.h>

#include "schema/base/utf8.h"
#include "server/identity/ruri.h"

namespace uplink::session {
namespace {

absl::Status AtFault(std::string_view field, const std::string& rule) {
  return absl::InvalidArgumentError(fmt::format("frame 1: hello.{}: {}", field, rule));
}

absl::Status CheckNumbers(const v1::Hello& hello) {
  if (hello.settled_seq() > model::kSeqMax) {
    return AtFault("settled_seq", fmt::format("{} is over 2^63-1", hello.settled_seq()));
  }
  if (hello.judged_seq() > model::kSeqMax) {
    return AtFault("judged_seq", fmt::format("{} is over 2^63-1", hello.judged_seq()));
  }
  if (hello.judged_seq() < hello.settled_seq()) {
    return AtFault("judged_seq", fmt::format("{} is below settled_seq {}", hello.judged_seq(),
                                             hello.settled_seq()));
  }
  return absl::OkStatus();
}

absl::Status CheckTexts(const v1::Hello& hello) {
  if (hello.robot_ruri().size() > model::kRuriBytesMax) {
    return AtFault("robot_ruri", fmt::format("{} bytes, the limit is {}", hello.robot_ruri().size(),
                                             model::kRuriBytesMax));
  }
  if (hello.agent_version().size() > model::kAgentVersionBytesMax) {
    return AtFault("agent_version",
                   fmt::format("{} bytes, the limit is {}", hello.agent_version().size(),
                               model::kAgentVersionBytesMax));
  }
  return absl::OkStatus();
}

absl::Status CheckSchema(const v1::Hello& hello) {
  switch (hello.schema()) {
    case v1::PAYLOAD_SCHEMA_ROVER_NEXUS_0_1:
      return absl::OkStatus();
    case v1::PAYLOAD_SCHEMA_UNSPECIFIED:
      return AtFault("schema", "it must be given");
    default:
      return AtFault("schema", fmt::format("{} is not a schema that this server knows",
                                           static_cast<int>(hello.schema())));
  }
}

std::string Shown(std::string_view text) { return PrintableUtf8(text, model::kRuriBytesMax); }

absl::Status CheckRobot(const v1::Hello& hello, const identity::PeerIdentity& peer) {
  if (hello.robot_ruri().empty() || hello.robot_ruri() == peer.ruri) return absl::OkStatus();
  return absl::PermissionDeniedError(
      fmt::format("the certificate of {} may not speak for hello.robot_ruri {}", Shown(peer.ruri),
                  Shown(hello.robot_ruri())));
}

absl::Status CheckGateway(const v1::Hello& hello, const identity::PeerIdentity& peer) {
  if (hello.robot_ruri().empty()) {
    return AtFault("robot_ruri", "a gateway must name the robot that it speaks for");
  }
  if (const auto flaw = identity::FlawOfRuri(hello.robot_ruri())) {
    return AtFault("robot_ruri", fmt::format("it {}", *flaw));
  }
  if (peer.gateway.MaySpeakFor(hello.robot_ruri())) return absl::OkStatus();
  const bool constrained = !peer.gateway.constraints.Allow(hello.robot_ruri());
  return absl::PermissionDeniedError(fmt::format(
      "the certificate of gateway {} may not speak for hello.robot_ruri {}{}", peer.gateway.subject,
      Shown(hello.robot_ruri()),
      constrained ? ": an authority of its chain does not allow that host (name constraints)"
                  : ""));
}

absl::Status CheckPeer(const v1::Hello& hello, const identity::PeerIdentity& peer) {
  switch (peer.role) {
    case identity::Role::kRobot:
      return CheckRobot(hello, peer);
    case identity::Role::kGateway:
      return CheckGateway(hello, peer);
    case identity::Role::kViewer:
    case identity::Role::kOperator:
    case identity::Role::kAdmin:
    case identity::Role::kMetrics:
      break;
  }
  return absl::UnauthenticatedError(
      fmt::format("the certificate is of role {}; the relay takes robots and gateways alone",
                  identity::ToText(peer.role)));
}

/// A gateway may name any robot of its fleet except these. A certificate with such a RURI has no
/// identity and does not get here.
absl::Status CheckNoTwin(std::string_view ruri) {
  if (!identity::NamesTwin(ruri)) return absl::OkStatus();
  return absl::PermissionDeniedError(
      fmt::format("hello.robot_ruri {} is a twin's, and twins are heard through their broker alone",
                  Shown(ruri)));
}

/// The terms of a valid Hello.
fleet::Claim ClaimOf(const v1::Hello& hello, const identity::PeerIdentity& peer) {
  if (peer.role == identity::Role::kRobot) {
    return {.robot = {.ruri = peer.ruri, .fleet = peer.fleet}, .bounds = peer.bounds};
  }
  return {.robot = {.ruri = hello.robot_ruri(), .fleet = peer.fleet},
          .grant = peer.gateway.ruris.empty() ? fleet::Grant::kFleet : fleet::Grant::kNamed,
          .gateway = peer.gateway.subject,
          .bounds = peer.bounds};
}

}  // namespace

absl::StatusOr<HelloTerms> CheckHello(const v1::Hello& hello, const identity::PeerIdentity& peer) {
  const auto session = model::SessionId::FromBytes(hello.session_id());
  if (!session) {
    return AtFault("session_id", fmt::format("{} bytes, it must have {}", hello.session_id().size(),
                                             model::SessionId::kBytes));
  }
  for (const absl::Status& status :
       {CheckSchema(hello), CheckTexts(hello), CheckNumbers(hello), CheckPeer(hello, peer)}) {
    if (!status.ok()) return status;
  }
  fleet::Claim claim = ClaimOf(hello, peer);
  if (absl::Status status = CheckNoTwin(claim.robot.ruri); !status.ok()) return status;
  return HelloTerms{.claim = std::move(claim),
                    .session = *session,
                    .settled_seq = hello.settled_seq(),
                    .judged_seq = hello.judged_seq(),
                    .declines_forwards = hello.declines_forwards(),
                    .agent_version = hello.agent_version()};
}

}  // namespace uplink::session
