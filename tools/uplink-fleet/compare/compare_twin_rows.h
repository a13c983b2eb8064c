#pragma once

#include <vector>

#include "tools/uplink-fleet/compare/findings.h"
#include "tools/uplink-fleet/compare/row_set.h"
#include "tools/uplink-fleet/compare/stored.h"
#include "tools/uplink-fleet/twin/script.h"

namespace uplink::synthetic {

/// One twin's account against the store: events, log lines and updates of scopes, each told apart
/// by its mark, as often as its delivery says; runs, faults and quarantine, where `no_robot` is
/// that of what belongs to no robot. Rows of other runs are passed over. Pure; any thread.
void CompareTwinRows(const TwinScript& twin, const StoredTwin& stored,
                     std::vector<v1::Quarantined>& no_robot, Findings& findings);

/// How often what was delivered so must be there. Pure.
[[nodiscard]] Times TimesOf(Delivery delivery);

}  // namespace uplink::synthetic
