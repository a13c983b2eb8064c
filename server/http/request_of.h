#pragma once

#include "server/http/incoming.h"
#include "server/http/message.h"
#include "server/http/peer.h"

namespace uplink::http {

[[nodiscard]] Method MethodOf(const Incoming::Parser::value_type& message);

/// A whole message of a peer, as handlers see it; `trusted`: who it asks for may stand in
/// X-Forwarded-For. The connection adds what it knows beside it.
[[nodiscard]] Request RequestOf(const Incoming::Parser::value_type& message, const Peer& peer,
                                bool trusted);

}  // namespace uplink::http
