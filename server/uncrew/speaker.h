#pragma once

#include <string_view>

#include <absl/status/statusor.h>

#include "server/fleet/claim.h"
#include "server/identity/peer_identity.h"

namespace uplink::uncrew {

/// The claim of a call with this `uav_id`. A robot's certificate speaks for its own drone,
/// whichever RURI it names: the call states that drone's id, or none. A gateway states one of its
/// robots, by id or by RURI.
///
/// Errors: kPermissionDenied: the certificate may not speak for that drone.
/// Thread: pure; any thread.
[[nodiscard]] absl::StatusOr<fleet::Claim> SpeakerOf(const identity::PeerIdentity& peer,
                                                     std::string_view uav_id,
                                                     std::string_view ruri_template);

}  // namespace uplink::uncrew
