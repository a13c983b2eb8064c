#pragma once

#include <optional>

#include "tools/uplink-fleet/run/run_options.h"

namespace uplink::synthetic {

/// Reads the command line; prints what is wrong with it, or the help. Nothing: exit with `code`.
[[nodiscard]] std::optional<RunOptions> ReadFlags(int argc, char** argv, int& code);

}  // namespace uplink::synthetic
