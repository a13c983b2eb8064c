#pragma once

#include <string_view>

#include "metrics/format.h"

namespace uplink::http {

/// The format that an Accept header asks for: OpenMetrics where it is named and liked at least as
/// much as plain text. Whatever cannot be read counts as not there.
[[nodiscard]] metrics::Format FormatFor(std::string_view accept);

/// Whether an Accept header names application/x-ndjson, and likes it at least as much as
/// application/json if that is named.
[[nodiscard]] bool PrefersLines(std::string_view accept);

/// Gzip where an Accept-Encoding header takes it.
[[nodiscard]] metrics::Coding CodingFor(std::string_view accept_encoding);

}  // namespace uplink::http
