#pragma once

#include <string>

#include "schema/base/clock.h"
#include "tools/uplink-fleet/compare/findings.h"
#include "tools/uplink-fleet/compare/stored.h"
#include "tools/uplink-fleet/drone/script.h"

namespace uplink::synthetic {

/// Silence of a drone, by the time between answers that it took, after which the server may have
/// called it offline: half of `presence.timeout`.
inline constexpr milliseconds kDroneSilence{5'000};

/// One drone's account against `GET /api/v1/robots/{ruri}` as the server wrote it when all was
/// answered: it is online by its calls, and each part of `Robot.uncrew` is the last one that it
/// published. Pure; any thread.
void CompareDroneLive(const DroneScript& drone, const std::string& look, Findings& findings);

/// The same against the store: each row of messages, events, faults and quarantine that its calls
/// must have left, once, and no other; which alerts are active, and each request to operators.
/// Alerts and requests of earlier runs are passed over. Pure; any thread.
void CompareDroneRows(const DroneScript& drone, const StoredDrone& stored, Findings& findings);

/// It was online at last, and not called offline unless it was silent. Pure; any thread.
void CompareDronePresence(const DroneScript& drone, const StoredDrone& stored, const Span& run,
                          Findings& findings);

}  // namespace uplink::synthetic
