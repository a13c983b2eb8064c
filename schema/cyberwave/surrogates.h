#pragma once

#include <string_view>

namespace uplink::cyberwave {

/// Whether a JSON text has an escaped half of a surrogate pair without its other half, which is no
/// character and cannot be UTF-8. Pure.
[[nodiscard]] bool HasLoneSurrogate(std::string_view text);

}  // namespace uplink::cyberwave
