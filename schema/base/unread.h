#pragma once

#include <string>

namespace uplink {

/// Why a file cannot be read, by errno, and what to do: `cannot be read: Permission denied; let
/// this user read it`. The path is not repeated; it decides the remedy alone.
///
/// Thread: pure; any thread.
[[nodiscard]] std::string UnreadText(const std::string& path, int error);

}  // namespace uplink
