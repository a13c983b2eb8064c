#include "server/store/oldest_snapshot.h"

namespace uplink::store {

void OldestSnapshot::AskOn(const std::function<bool(std::function<void()>)>& post) {
  if (!ask_ || asking_.exchange(true)) return;
  const bool posted = post([this] {
    if (const absl::StatusOr<milliseconds> age = ask_(); age.ok()) age_ms_.store(age->count());
    asking_.store(false);
  });
  // Where the queue of reads is full, the next round asks again.
  if (!posted) asking_.store(false);
}

}  // namespace uplink::store
