#pragma once

#include "server/broker/probe.h"
#include "server/mqtt/settings.h"

namespace uplink::broker {

/// Notes when the certificate expires that the next connection is made with, as its file says now;
/// 0 without one. Of a file that cannot be used the next connection speaks, and what was known of
/// it stays. Blocks on the file.
void NoteCertificate(const mqtt::ClientSettings& settings, BrokerProbe& probe);

}  // namespace uplink::broker
