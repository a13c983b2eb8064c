#include "server/store/samples.h"

namespace uplink::store {

void AddSamples(const storage::StoreFacts& facts, metrics::Exposition& page) {
  using enum metrics::MetricId;
  page.Add(kStoreUnsafe, facts.unsafe ? 1 : 0);
  page.Add(kStoreClockOffset, facts.clock_offset);
  page.Add(kStoreCommitsInDoubt, facts.commits_in_doubt);
}

}  // namespace uplink::store
