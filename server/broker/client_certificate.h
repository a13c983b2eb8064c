#pragma once

#include "server/broker/probe.h"
#include "server/mqtt/settings.h"

namespace uplink::broker {

/// Notes when the certificate in the client's file expires; 0 without one. The next connection uses
/// that file. If the file cannot be used, the old value stays: the next connection reports the
/// error. Blocks on the file.
void NoteCertificate(const mqtt::ClientSettings& settings, BrokerProbe& probe);

}  // namespace uplink::broker
