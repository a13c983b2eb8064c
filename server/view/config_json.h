#pragma once

#include <string>

#include <absl/status/statusor.h>

#include "server/config/effective.h"
#include "server/view/form.h"

namespace uplink::view {

/// What a server's keys are now, by section, as ServerConfig. Errors and thread: as json.h.
[[nodiscard]] absl::StatusOr<std::string> Encode(Form form, const config::InEffect& in_effect);

}  // namespace uplink::view
