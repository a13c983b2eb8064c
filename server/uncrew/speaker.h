#pragma once

#include <string_view>

#include <absl/status/statusor.h>

#include "server/fleet/claim.h"
#include "server/identity/peer_identity.h"

namespace uplink::uncrew {

/// As whom a call speaks that says `uav_id`. A robot's certificate is that of its own drone, by
/// whichever RURI it names: it says its id or nothing. A gateway names one of its robots, by id or
/// by RURI.
///
/// Errors: kPermissionDenied: the certificate may not speak for that drone.
/// Thread: pure; any thread.
[[nodiscard]] absl::StatusOr<fleet::Claim> SpeakerOf(const identity::PeerIdentity& peer,
                                                     std::string_view uav_id,
                                                     std::string_view ruri_template);

}  // namespace uplink::uncrew
