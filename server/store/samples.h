#pragma once

#include "metrics/exposition.h"
#include "server/store/access_probe.h"
#include "server/store/lease_probe.h"
#include "server/store/space_judge.h"
#include "server/store/vouched_clock.h"
#include "storage/store.h"
#include "storage/store_facts.h"

namespace uplink::store {

/// Facts of the store, for a page of metrics. Any thread.
void AddSamples(const storage::StoreFacts& facts, metrics::Exposition& page);
/// The state of its disk, and what is done about it. Any thread.
void AddSamples(const SpaceView& view, metrics::Exposition& page);
/// Whether the civil clock is vouched for, and by how much it jumped. Any thread.
void AddSamples(const VouchedClock& clock, metrics::Exposition& page);
/// Revocations that count. Any thread.
void AddSamples(const AccessProbe& probe, metrics::Exposition& page);
/// What its leases told. Any thread.
void AddSamples(const LeaseProbe& probe, metrics::Exposition& page);

}  // namespace uplink::store
