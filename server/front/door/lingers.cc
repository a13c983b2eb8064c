#include "server/front/door/lingers.h"

#include "schema/base/check.h"

namespace uplink::front {

bool Lingers::Begin(const std::optional<KeyDigest>& key) {
  const std::lock_guard lock(mutex_);
  if (all_ >= max_) return false;
  if (key) {
    const auto found = by_key_.find(*key);
    if (found != by_key_.end() && found->second >= kLingersPerKeyMax) return false;
    ++by_key_[*key];
  }
  ++all_;
  return true;
}

void Lingers::End(const std::optional<KeyDigest>& key) {
  const std::lock_guard lock(mutex_);
  UPLINK_CHECK(all_ > 0, "one ends that did not begin");
  --all_;
  if (!key) return;
  const auto found = by_key_.find(*key);
  UPLINK_CHECK(found != by_key_.end(), "one of a key ends that did not begin");
  if (--found->second == 0) by_key_.erase(found);
}

}  // namespace uplink::front
