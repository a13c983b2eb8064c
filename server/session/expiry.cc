#include "server/session/expiry.h"

#include <cstdint>
#include <variant>

namespace uplink::session {

bool ExpiredOnArrival(const model::Body& body, SystemTime now) {
  const auto passed = [now](std::int64_t expiry_ms) {
    return expiry_ms != 0 && expiry_ms <= UnixMs(now);
  };
  if (const auto* shape = std::get_if<model::ShapeOp>(&body)) {
    return shape->upsert() != nullptr && passed(shape->upsert()->expire_time_ms);
  }
  if (const auto* object = std::get_if<model::ObjectOp>(&body)) {
    return object->upsert() != nullptr && passed(object->upsert()->expires_unix_time_ms);
  }
  return false;
}

}  // namespace uplink::session
