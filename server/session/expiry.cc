#include "server/session/expiry.h"

#include <cstdint>
#include <variant>

namespace uplink::session {

namespace {

/// When an upsert of a shape or object expires, Unix milliseconds; 0: never, or it is none.
std::int64_t ExpiryOf(const model::Body& body) {
  if (const auto* shape = std::get_if<model::ShapeOp>(&body)) {
    return shape->upsert() == nullptr ? 0 : shape->upsert()->expire_time_ms;
  }
  if (const auto* object = std::get_if<model::ObjectOp>(&body)) {
    return object->upsert() == nullptr ? 0 : object->upsert()->expires_unix_time_ms;
  }
  return 0;
}

}  // namespace

bool ExpiredOnArrival(const model::Body& body, SystemTime now,
                      const storage::ClockTrust& clock_trust) {
  const std::int64_t expiry_ms = ExpiryOf(body);
  return expiry_ms != 0 && expiry_ms <= UnixMs(now) && clock_trust.VouchesFor(now);
}

}  // namespace uplink::session
