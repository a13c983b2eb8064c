#pragma once

#include "tools/uplink-fleet/robot/behaviour/seeded.h"
#include "tools/uplink-fleet/twin/account.h"
#include "tools/uplink-fleet/twin/voice.h"

namespace uplink::synthetic {

/// What the parts of a twin's script speak with; all of it outlives them.
struct Speech {
  Voice& voice;
  TwinAccount& account;
  Seeded& chance;
};

}  // namespace uplink::synthetic
