#pragma once

#include "schema/base/check.h"
#include "schema/base/utf8.h"
#include "schema/model/ids.h"
#include "schema/model/rejection.h"

namespace uplink::fuzz {

/// What the words of every fault keep to, whatever the input was. Aborts if one does not.
inline void CheckFault(const model::Rejection& fault) {
  UPLINK_CHECK(!fault.detail.empty(), "a fault says something");
  UPLINK_CHECK(fault.detail.size() <= model::kDetailBytesMax, "detail fits its frame");
  UPLINK_CHECK(IsCleanUtf8(fault.detail), "detail is text");
  UPLINK_CHECK(IsCleanUtf8(fault.field), "field is text");
}

}  // namespace uplink::fuzz
