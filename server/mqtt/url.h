#pragma once

#include "server/config/broker_url.h"

namespace uplink::mqtt {

/// Where a broker is; the configuration judges it, and takes it apart.
using Url = config::BrokerUrl;

}  // namespace uplink::mqtt
