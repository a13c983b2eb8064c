#pragma once

#include "schema/base/check.h"
#include "schema/base/utf8.h"
#include "schema/model/ids.h"
#include "schema/model/rejection.h"

namespace uplink::fuzz {

/// What the words of every violation keep to, whatever the input was. Aborts if one does not.
inline void CheckViolation(const model::Rejection& violation) {
  UPLINK_CHECK(!violation.detail.empty(), "a violation says something");
  UPLINK_CHECK(violation.detail.size() <= model::kDetailBytesMax, "detail fits its frame");
  UPLINK_CHECK(IsCleanUtf8(violation.detail), "detail is text");
  UPLINK_CHECK(IsCleanUtf8(violation.field), "field is text");
}

}  // namespace uplink::fuzz
