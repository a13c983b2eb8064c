#pragma once

#include "tools/uplink-fleet/compare/findings.h"
#include "tools/uplink-fleet/compare/stored_twin.h"
#include "tools/uplink-fleet/twin/script.h"

namespace uplink::synthetic {

/// One twin's account against what the server showed of its two robots when all was sent: each live
/// value is the last one that was sent, nothing is shown that was not, no secret is, and sessions
/// are as their marks left them. Pure; any thread.
void CompareTwinLive(const TwinScript& twin, const TwinLook& look, Findings& findings);

}  // namespace uplink::synthetic
