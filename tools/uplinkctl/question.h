#pragma once

#include <string_view>

namespace uplink::ctl {

/// Asks a question on the terminal. Whoever answers anything but `yes` is taken for a no.
[[nodiscard]] bool SaysYes(std::string_view question);

}  // namespace uplink::ctl
