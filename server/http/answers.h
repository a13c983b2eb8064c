#pragma once

#include <cstdint>
#include <string>

#include <absl/status/statusor.h>

#include "server/http/message.h"
#include "server/http/parameters.h"

namespace uplink::http {

/// The JSON as an answer, or the answer for what failed.
[[nodiscard]] Response JsonResponse(absl::StatusOr<std::string> json);

/// `pageSize` of every list.
[[nodiscard]] std::uint32_t ReadPageSize(Parameters& parameters);

}  // namespace uplink::http
