#pragma once

#include "server/mqtt/packets.h"
#include "storage/deliveries.h"

namespace uplink::broker {

/// The digest of topic and payload, by which a redelivered message is recognized. If the payload
/// was skipped, its size stands for it. Pure.
[[nodiscard]] storage::DeliveryDigest DigestOf(const mqtt::Publish& publish);

}  // namespace uplink::broker
