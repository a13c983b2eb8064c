#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/bench/fair/misdeed.h"

namespace uplink::bench {

/// What `./dev bench fair` was asked for. A value.
struct FairFlags {
  std::string json;
  std::string commit = "unknown";
  /// All if empty.
  std::vector<Misdeed> misdeeds;
  /// `sqlite` or `postgres`, which needs the cluster of UPLINK_TEST_POSTGRES.
  std::string store = "sqlite";
  std::string server_bin;
  int robots = 500;
  int seconds = 12;
  int rounds = 1;
  /// What a robot may have of the server's memory by itself.
  int share_mib = 8;
};

/// Reads them into `flags`, whose values are the defaults. The exit code where the program is to
/// end: help was asked for, or the use was wrong and the reason printed.
[[nodiscard]] std::optional<int> ParseFairFlags(int argc, const char* const* argv,
                                                FairFlags& flags);

}  // namespace uplink::bench
