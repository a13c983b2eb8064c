#pragma once

#include <string_view>

namespace uplink::json {

/// Whether a text is one object of JSON, and nothing else: then it may stand in another text as it
/// is. It builds no value, so that it needs no memory. Pure; any thread.
[[nodiscard]] bool IsObjectText(std::string_view text);

}  // namespace uplink::json
