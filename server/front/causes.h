#pragma once

#include "server/front/http2/frame_rates.h"
#include "server/front/tls/tls_engine.h"
#include "server/transport/turned_away.h"

namespace uplink::front {

/// What a handshake that failed, or too many frames of a kind, count as.
[[nodiscard]] transport::TurnedAway CauseOf(TlsEngine::Failure failure);
[[nodiscard]] transport::TurnedAway CauseOf(FrameKind kind);

}  // namespace uplink::front
