#pragma once

#include <absl/status/statusor.h>

#include "schema/model/ids.h"
#include "server/fleet/claim.h"
#include "server/identity/peer_identity.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::session {

/// What a Hello that is in order asks for. A value.
struct HelloTerms {
  /// The robot, and by whose word the stream speaks for it.
  fleet::Claim claim;
  model::SessionId session;
  model::Seq settled_seq = 0;
  model::Seq judged_seq = 0;
  bool declines_forwards = false;
};

/// Checks the first frame of a stream against the protocol and the peer's certificate.
///
/// Errors:  kInvalidArgument names the field and the rule; kPermissionDenied when the certificate
///          may not speak for robot_ruri, and no certificate for a twin's; kUnauthenticated when it
///          is no robot's and no gateway's.
/// Thread:  pure; any thread.
[[nodiscard]] absl::StatusOr<HelloTerms> CheckHello(const v1::Hello& hello,
                                                    const identity::PeerIdentity& peer);

}  // namespace uplink::session
