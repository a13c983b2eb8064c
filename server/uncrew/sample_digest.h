#pragma once

#include <string_view>

#include "schema/model/uncrew/types.h"
#include "storage/samples.h"

namespace uplink::uncrew {

/// The digest of a sample's type and request (times and content), by which it is recognized when it
/// comes again. Pure.
[[nodiscard]] storage::SampleDigest DigestOf(model::uncrew::SampleType type,
                                             std::string_view request);

}  // namespace uplink::uncrew
