#include "server/session/pending_batch.h"

#include <cstddef>
#include <string_view>
#include <utility>

namespace uplink::session {

void PendingBatch::Keep() {
  if (empty() || kept_ != nullptr) return;
  auto kept = std::make_unique<Kept>();
  kept->uplinks.assign(uplinks_.begin(), uplinks_.end());
  std::size_t bytes = 0;
  for (const UplinkView& uplink : uplinks_) bytes += uplink.payload.size();
  kept->bytes.reserve(bytes);
  // There is room for all, so appending moves no byte.
  for (UplinkView& uplink : kept->uplinks) {
    kept->bytes.append(uplink.payload);
    uplink.payload =
        std::string_view(kept->bytes).substr(kept->bytes.size() - uplink.payload.size());
  }
  uplinks_ = kept->uplinks;
  kept_ = std::move(kept);
}

void PendingBatch::Drop() {
  uplinks_ = {};
  kept_.reset();
}

}  // namespace uplink::session
