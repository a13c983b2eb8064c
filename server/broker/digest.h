#pragma once

#include "server/mqtt/packets.h"
#include "storage/deliveries.h"

namespace uplink::broker {

/// Of topic and payload, by which a message is known again. Of a payload that was read past, its
/// size. Pure.
[[nodiscard]] storage::DeliveryDigest DigestOf(const mqtt::Publish& publish);

}  // namespace uplink::broker
