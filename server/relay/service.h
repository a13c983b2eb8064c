#pragma once

#include "uplink/v1/relay.grpc.pb.h"

namespace uplink::relay {

/// UplinkRelay with frames as byte buffers: typed reads would hide why a frame is bad (measured).
using RelayService = v1::UplinkRelay::WithRawMethod_Relay<v1::UplinkRelay::Service>;

}  // namespace uplink::relay
