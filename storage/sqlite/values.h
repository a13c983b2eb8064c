#pragma once

#include <string>
#include <string_view>

namespace uplink::storage::sqlite {

/// A text to bind; it must outlive the run.
[[nodiscard]] inline std::string_view View(const std::string& text) { return text; }

}  // namespace uplink::storage::sqlite
