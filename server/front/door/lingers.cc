#include "server/front/door/lingers.h"

#include "schema/base/check.h"

namespace uplink::front {

bool Lingers::Begin(const std::optional<KeyDigest>& key) {
  const std::lock_guard lock(mutex_);
  if (all_ >= max_) return false;
  if (key) {
    if (by_key_.Of(*key) >= kLingersPerKeyMax) return false;
    by_key_.Add(*key);
  }
  ++all_;
  return true;
}

void Lingers::End(const std::optional<KeyDigest>& key) {
  const std::lock_guard lock(mutex_);
  UPLINK_CHECK(all_ > 0, "one ends that did not begin");
  --all_;
  if (key) by_key_.Drop(*key);
}

}  // namespace uplink::front
