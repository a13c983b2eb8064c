#pragma once

#include <string>
#include <vector>

#include "tests/bench/figures.h"
#include "tests/support/flags.h"

namespace uplink::bench {

/// What every benchmark is asked for. A value.
struct BenchFlags {
  std::string json = {};
  std::string commit = "unknown";
  int rounds = 1;
  int seconds = 1;

  void AddTo(testing::Flags& flags);
};
inline constexpr testing::FlagRange kSecondsRange{1, 600};

/// Prints the heading and the table, and keeps the rows where `--json` says: the exit code.
[[nodiscard]] int Publish(const BenchFlags& flags, const std::string& heading,
                          const std::vector<Row>& rows);

}  // namespace uplink::bench
