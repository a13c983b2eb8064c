#pragma once

#include <span>
#include <string>
#include <string_view>

#include "schema/base/clock.h"
#include "server/log/logger.h"

namespace uplink::log {

/// One event as a line, which has no newline within it or at its end. Pure.
[[nodiscard]] std::string LineText(Format format, Level level, std::string_view event,
                                   std::span<const Field> fields, SystemTime time);

}  // namespace uplink::log
