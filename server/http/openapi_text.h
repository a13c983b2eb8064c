#pragma once

#include <string_view>

namespace uplink::http {

/// docs/reference/openapi.yaml, as it was when the program was built.
[[nodiscard]] std::string_view OpenapiText();

}  // namespace uplink::http
