#include "server/forward/forwarding.h"

#include <random>

#include "server/forward/limits.h"

namespace uplink::forward {

Forwarding::Forwarding(const Context& context)
    : clock_(context.clock),
      forwards_({kSharedBytesMax, kFleetBytesMax, kRobotBytesMax}, std::mt19937_64(context.seed)),
      rounds_(
          {context.clock, context.logger, context.items, forwards_, probe_, context.clock_trust}),
      listener_({context.logger, probe_, context.change_signal, [this] { rounds_.Wake(); },
                 context.seed}) {}

void Forwarding::AddSamples(metrics::Exposition& page) const {
  using enum metrics::MetricId;
  const Forwards::Sum sum = forwards_.sum();
  const auto number = [](auto value) { return static_cast<std::int64_t>(value); };
  page.Add(kForwardsDue, number(sum.counts.due));
  page.Add(kForwardsSettled, number(sum.counts.written), {"written"});
  page.Add(kForwardsSettled, number(sum.counts.coalesced), {"coalesced"});
  page.Add(kForwardsSettled, number(sum.counts.replaced), {"snapshot"});
  page.Add(kForwardsSettled, number(sum.counts.dropped), {"dropped"});
  page.Add(kForwardsWaiting, number(sum.waiting));
  page.Add(kForwardSnapshots, number(sum.counts.snapshots));
  page.Add(kForwardSnapshotItems, number(sum.counts.snapshot_items));
  page.Add(kForwardSnapshotsOpen, number(sum.snapshots_open));
  page.Add(kForwardOverflows, number(sum.counts.overflows));
  page.Add(kForwardReceivers, number(sum.receivers));
  page.Add(kForwardItems, number(sum.items));
  page.Add(kForwardBytes, number(sum.bytes));
  page.Add(kForwardBytesLimit, number(forwards_.bytes_max()));
  page.Add(kForwardLeftOut, number(sum.left_out));
  page.Add(kForwardUnreadable, probe_.unreadable);
  page.Add(kForwardUnreadableNow, probe_.unreadable_now);
  page.Add(kForwardPaced, probe_.paced_now);
  page.Add(kForwardChanges, probe_.changes);
  page.Add(kForwardReadsOfAll, probe_.reads_of_all);
  page.Add(kForwardFailing, probe_.failing);
  const std::int64_t followed_at = probe_.followed_at_ms.value();
  const std::int64_t age = followed_at == 0 ? 0 : SteadyMs(clock_.Steady()) - followed_at;
  page.Add(kForwardLookAge, milliseconds(age));
  page.Add(kForwardHeard, probe_.heard);
  page.Add(kForwardListenFailing, probe_.listen_failing);
}

}  // namespace uplink::forward
