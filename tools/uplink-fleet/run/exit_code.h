#pragma once

namespace uplink::synthetic {

/// Exit codes of the program (tools/README.md).
inline constexpr int kExitDone = 0;
inline constexpr int kExitFailed = 1;
inline constexpr int kExitWrongUse = 2;
inline constexpr int kExitMismatch = 3;

}  // namespace uplink::synthetic
