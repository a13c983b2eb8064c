#pragma once

#include <utility>

#include "schema/model/record.h"
#include "schema/rules/violations.h"
#include "schema/uplink.capnp.h"

/// One function per variant, in the file of its family: reads the member's struct into the model
/// and judges it on the way, in schema order. What it returns is fit to keep unless `violations`
/// says that the message is rejected. They may throw kj::Exception (a pointer that leads nowhere);
/// ReadMessage (decode/message.h) catches it.
namespace uplink::schema {

// DecodeMotionTelemetry and so on, one per row of model/variants.h.
#define UPLINK_VARIANT(Member, name, Body, settling) \
  [[nodiscard]] model::Body Decode##Member(          \
      decltype(std::declval<wire::UplinkMsg::Reader>().get##Member()) in, Violations& violations);
UPLINK_VARIANTS(UPLINK_VARIANT)
#undef UPLINK_VARIANT

}  // namespace uplink::schema
