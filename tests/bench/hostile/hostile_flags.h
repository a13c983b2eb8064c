#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/bench/hostile/attack.h"

namespace uplink::bench {

/// What `./dev bench hostile` was asked for. A value.
struct HostileFlags {
  std::string json;
  std::string commit = "unknown";
  /// All if empty.
  std::vector<const Attack*> attacks;
  std::string server_bin;
  int seconds = 5;
  int rounds = 1;
  int robots = 1;
};

/// Reads them into `flags`, whose values are the defaults. The exit code where the program is to
/// end: help was asked for, or the use was wrong and the reason printed.
[[nodiscard]] std::optional<int> ParseHostileFlags(int argc, const char* const* argv,
                                                   HostileFlags& flags);

}  // namespace uplink::bench
