#pragma once

#include <string>

#include "server/front/door/origin.h"
#include "server/front/tls/tls_peer.h"
#include "server/transport/call_handler.h"

namespace uplink::front {

/// What a caller has shown: this peer, from there, with this metadata `authorization`.
[[nodiscard]] transport::CallerProof ProofOf(const TlsPeer& peer, const Origin& origin,
                                             std::string authorization);

}  // namespace uplink::front
