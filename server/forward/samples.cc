#include "server/forward/samples.h"

namespace uplink::forward {

void AddSamples(const Forwards& forwards, const ForwardProbe& probe, metrics::Exposition& page) {
  using enum metrics::MetricId;
  const Forwards::Sum sum = forwards.sum();
  const auto number = [](auto value) { return static_cast<std::int64_t>(value); };
  page.Add(kForwardsDue, number(sum.counts.due));
  page.Add(kForwardsSettled, number(sum.counts.written), {"written"});
  page.Add(kForwardsSettled, number(sum.counts.coalesced), {"coalesced"});
  page.Add(kForwardsSettled, number(sum.counts.replaced), {"snapshot"});
  page.Add(kForwardsSettled, number(sum.counts.dropped), {"dropped"});
  page.Add(kForwardsWaiting, number(sum.waiting));
  page.Add(kForwardSnapshots, number(sum.counts.snapshots));
  page.Add(kForwardSnapshotItems, number(sum.counts.snapshot_items));
  page.Add(kForwardReceivers, number(sum.receivers));
  page.Add(kForwardItems, number(sum.items));
  page.Add(kForwardBytes, number(sum.bytes));
  page.Add(kForwardBytesLimit, number(forwards.bytes_max()));
  page.Add(kForwardLeftOut, number(sum.left_out));
  page.Add(kForwardUnreadable, probe.unreadable);
  page.Add(kForwardChanges, probe.changes);
  page.Add(kForwardReadsOfAll, probe.reads_of_all);
  page.Add(kForwardFailing, probe.failing);
}

}  // namespace uplink::forward
