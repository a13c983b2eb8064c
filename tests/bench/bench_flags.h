#pragma once

#include <string>
#include <vector>

#include "server/config/flags.h"
#include "tests/bench/figures.h"

namespace uplink::bench {

/// What every benchmark is asked for. A value.
struct BenchFlags {
  std::string json = {};
  std::string commit = "unknown";
  int rounds = 1;
  int seconds = 1;

  void AddTo(config::Flags& flags);
};
inline constexpr config::FlagRange kSecondsRange{1, 600};

/// Prints the heading and the table, and keeps the rows where `--json` says: the exit code.
[[nodiscard]] int Publish(const BenchFlags& flags, const std::string& heading,
                          const std::vector<Row>& rows);

}  // namespace uplink::bench
