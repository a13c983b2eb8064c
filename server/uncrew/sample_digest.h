#pragma once

#include <string_view>

#include "schema/model/uncrew/types.h"
#include "storage/samples.h"

namespace uplink::uncrew {

/// Of a sample's type, times and content, by which it is known again: the bytes of its request.
/// Pure.
[[nodiscard]] storage::SampleDigest DigestOf(model::uncrew::SampleType type,
                                             std::string_view request);

}  // namespace uplink::uncrew
