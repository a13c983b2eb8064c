#pragma once

#include <string>
#include <string_view>

namespace uplink::http {

/// The ETag of an answer (RFC 9110, 8.8.3): the same for the same text. Weak, because gzip carries
/// the same text in other bytes.
[[nodiscard]] std::string EntityTag(std::string_view text);

/// Whether If-None-Match names this tag, by the weak comparison, or is `*`: the client has the
/// answer already. What follows a part that cannot be read counts as not there.
[[nodiscard]] bool NamesTag(std::string_view if_none_match, std::string_view tag);

}  // namespace uplink::http
