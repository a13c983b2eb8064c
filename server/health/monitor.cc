#include "server/health/monitor.h"

#include "server/health/process.h"

namespace uplink::health {

Monitor::Monitor(const Sources& sources)
    : sources_(sources),
      liveness_(sources.clock, sources.sessions.streams_total),
      certificate_expiry_ms_(UnixMs(sources.certificate_expiry)) {}

Readiness Monitor::readiness() const {
  const journal::JournalLimits share =
      journal::ShareOf(sources_.journal_limits, sources_.journals.all().size());
  const storage::StoreFacts store = sources_.store_facts();
  const SteadyTime went_back = sources_.journal_probe.went_back_at.load();
  return ReadinessOf({
      .now = sources_.clock.System(),
      .draining = draining(),
      .certificate_expiry = certificate_expiry(),
      .certificate_fits = certificate_fits_.load(),
      .http = sources_.http(),
      .robots = {sources_.fleet.size(), sources_.fleet.robots_max()},
      .store_failing =
          sources_.journal_probe.store_failing.value() != 0 || sources_.robots_unread(),
      .store_unsafe = store.unsafe,
      .store_space_scarce = sources_.store_space_scarce(),
      .store_went_back =
          went_back != SteadyTime() && sources_.clock.Steady() - went_back < kWentBackShown,
      .store_old_snapshot = store.old_snapshot(),
      .clock_not_vouched = sources_.clock_trust != nullptr && !sources_.clock_trust->vouched(),
      .lease_failing = sources_.lease_failing(),
      .relay_behind = liveness_.behind(),
      .forward_incomplete = sources_.forward_incomplete(),
      .live_state_over = sources_.live_state_over(),
      .broker = sources_.broker(),
      .series_left_out = sources_.series_left_out(),
      .journal_bytes = {sources_.journals.bytes_worst(), share.bytes_max},
      .journal_records = {sources_.journals.records_worst(), share.records_max},
      .journal_oldest = sources_.journals.oldest(sources_.clock.Steady()),
      .descriptors = {OpenDescriptors(), DescriptorsMax()},
  });
}

}  // namespace uplink::health
