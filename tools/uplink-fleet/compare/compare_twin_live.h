#pragma once

#include <map>
#include <string>

#include <boost/json.hpp>

#include "schema/base/clock.h"
#include "tools/uplink-fleet/compare/findings.h"
#include "tools/uplink-fleet/compare/stored.h"
#include "tools/uplink-fleet/twin/script.h"

namespace uplink::synthetic {

/// One twin's account against what the server showed of its two robots when all was sent: each live
/// value is the last one that was sent, nothing is shown that was not, no secret is, and sessions
/// are as their marks left them. Pure; any thread.
void CompareTwinLive(const TwinScript& twin, const TwinLook& look, Findings& findings);

/// Silence of a robot, by the time between what it sent, after which the server may have called it
/// offline: half of `cyberwave.presence_timeout`.
inline constexpr milliseconds kTwinSilence{10'000};

/// Both robots were online at last, and not called offline unless they were silent. Pure.
void CompareTwinPresence(const TwinScript& twin, const StoredTwin& stored, const Span& run,
                         Findings& findings);

/// `Robot.cyberwave` in parts that change together, each as CanonicalText, without the arrivals by
/// the server's clock: `position`, `edgeHealth/ID`, `metrics/CATEGORY`,
/// `joints/SOURCE/NAME/CHANNEL` and so on. Not sessions and counts. Pure; any thread.
[[nodiscard]] std::map<std::string, std::string> LivePartsOf(const boost::json::object& cyberwave);

}  // namespace uplink::synthetic
