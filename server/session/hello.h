#pragma once

#include <string>

#include <absl/status/statusor.h>

#include "schema/model/ids.h"
#include "server/fleet/claim.h"
#include "server/identity/peer_identity.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::session {

/// The requests of a valid Hello. A value.
struct HelloTerms {
  /// The robot, and on whose authority the stream speaks for it.
  fleet::Claim claim;
  model::SessionId session;
  model::Seq settled_seq = 0;
  model::Seq judged_seq = 0;
  bool declines_forwards = false;
  std::string agent_version = {};
};

/// Checks the first frame of a stream against the protocol and the peer's certificate.
///
/// Errors:  kInvalidArgument names the field and the rule; kPermissionDenied if the certificate may
///          not speak for robot_ruri, which no certificate may for a twin's; kUnauthenticated if it
///          is neither a robot's nor a gateway's.
/// Thread:  pure; any thread.
[[nodiscard]] absl::StatusOr<HelloTerms> CheckHello(const v1::Hello& hello,
                                                    const identity::PeerIdentity& peer);

}  // namespace uplink::session
