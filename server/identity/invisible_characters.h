#pragma once

#include <optional>
#include <string_view>

namespace uplink::identity {

/// The first invisible character of the text, which may make two names look alike: of no width, a
/// control character beyond ASCII (C1), a separator of lines, or one that Unicode 14.0 has not
/// assigned. Nothing if there is none. `text` must be well-formed UTF-8.
///
/// Thread: pure; any thread.
[[nodiscard]] std::optional<char32_t> InvisibleCharacter(std::string_view text);

}  // namespace uplink::identity
