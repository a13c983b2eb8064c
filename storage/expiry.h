#pragma once

#include <cstdint>

#include "schema/base/clock.h"
#include "schema/model/spatial.h"
#include "storage/clock_trust.h"
#include "storage/store_rules.h"

namespace uplink::storage {

/// When the object expires, Unix milliseconds; 0: never. One that names no time lives for
/// `rules.object_ttl` from its arrival.
[[nodiscard]] inline std::int64_t ExpiryOf(const model::Object& object, SystemTime received_at,
                                           const StoreRules& rules) {
  if (object.expires_unix_time_ms != 0) return object.expires_unix_time_ms;
  if (rules.object_ttl.count() == 0) return 0;
  return UnixMs(received_at + rules.object_ttl);
}

/// The latest time of expiry, Unix milliseconds, that counts as past at `now`. 0, so that nothing
/// counts as expired, until the clock is vouched for.
[[nodiscard]] inline std::int64_t ExpiredByMs(SystemTime now, const StoreRules& rules) {
  return Vouches(rules.clock, now) ? UnixMs(now) : 0;
}

/// True from the time of expiry on; 0: it never expires.
[[nodiscard]] constexpr bool IsExpired(std::int64_t expires_at_ms, std::int64_t now_ms) {
  return expires_at_ms != 0 && expires_at_ms <= now_ms;
}

}  // namespace uplink::storage
