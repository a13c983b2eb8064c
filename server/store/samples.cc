#include "server/store/samples.h"

namespace uplink::store {

using enum metrics::MetricId;

void AddSamples(const storage::StoreFacts& facts, metrics::Exposition& page) {
  page.Add(kStoreUnsafe, facts.unsafe ? 1 : 0);
  page.Add(kStoreClockOffset, facts.clock_offset);
  page.Add(kStoreCommitsInDoubt, facts.commits_in_doubt);
  page.Add(kStoreOldestSnapshot, facts.oldest_snapshot);
}

void AddSamples(const SpaceView& view, metrics::Exposition& page) {
  if (view.space) {
    page.Add(kStoreFreeBytes, view.space->free_bytes);
    page.Add(kStoreFreeMinBytes, view.free_min);
    page.Add(kStoreDiskBytes, view.space->total_bytes);
    if (view.space->wal_bytes) page.Add(kStoreWalBytes, *view.space->wal_bytes);
  }
  page.Add(kStoreStopped, view.state == SpaceState::kStopped ? 1 : 0);
  page.Add(kStoreRobotsLimited, view.robots_limited);
}

void AddSamples(const VouchedClock& clock, metrics::Exposition& page) {
  page.Add(kClockVouched, clock.vouched() ? 1 : 0);
  page.Add(kClockAhead, clock.ahead());
}

void AddSamples(const AccessProbe& probe, metrics::Exposition& page) {
  page.Add(kRevocations, probe.of_store, {"store"});
  page.Add(kRevocations, probe.of_files, {"files"});
}

void AddSamples(const LeaseProbe& probe, metrics::Exposition& page) {
  page.Add(kLeaseRenewals, probe.renewed);
  page.Add(kLeaseFailing, probe.failing.value());
  page.Add(kLeaseOthers, probe.others.value());
  page.Add(kLeaseOthersLate, probe.others_late.value());
}

}  // namespace uplink::store
