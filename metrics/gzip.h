#pragma once

#include <string>
#include <string_view>

namespace uplink::metrics {

/// `plain` compressed by gzip into `out`, whose memory is used again, at the fastest level: a
/// scrape is repetitive, and shrinks to a tenth all the same.
void Gzip(std::string_view plain, std::string& out);

}  // namespace uplink::metrics
