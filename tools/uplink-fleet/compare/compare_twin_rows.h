#pragma once

#include <string>
#include <vector>

#include "tools/uplink-fleet/compare/compare_presence.h"
#include "tools/uplink-fleet/compare/findings.h"
#include "tools/uplink-fleet/compare/stored_twin.h"
#include "tools/uplink-fleet/twin/script.h"

namespace uplink::synthetic {

/// One twin's account against the store: events, log lines and updates of scopes, each told apart
/// by its mark, as often as its delivery says; `nobody` is the quarantine of what belongs to no
/// robot. Runs, faults, quarantine and presence follow. Rows of other runs are passed over. Pure;
/// any thread.
void CompareTwinRows(const TwinScript& twin, const StoredTwin& stored,
                     std::vector<v1::Quarantined>& nobody, Findings& findings);

/// Each of its own; CompareTwinRows calls them.
void CompareTwinRuns(const TwinScript& twin, const StoredTwin& stored, Findings& findings);
void CompareTwinFaults(const TwinScript& twin, const StoredTwin& stored, Findings& findings);
void CompareTwinQuarantine(const TwinScript& twin, const StoredTwin& stored,
                           std::vector<v1::Quarantined>& nobody, Findings& findings);

/// Silence of a robot, by the time between what it sent, after which the server may have called it
/// offline: half of `cyberwave.presence_timeout`.
inline constexpr milliseconds kTwinSilence{10'000};
/// Both robots were online at last, and not called offline unless they were silent.
void CompareTwinPresence(const TwinScript& twin, const StoredTwin& stored, const Span& run,
                         Findings& findings);

/// What is wrong with something that was found `found` times; empty: nothing.
[[nodiscard]] std::string WrongCount(Delivery delivery, std::size_t found);
/// Whether it must be there at all.
[[nodiscard]] bool MustBeThere(Delivery delivery);
/// The RURI of that robot of the twin.
[[nodiscard]] const std::string& RuriOf(const TwinScript& twin, Side side);

}  // namespace uplink::synthetic
