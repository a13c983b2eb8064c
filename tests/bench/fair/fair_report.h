#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/bench/figures.h"

namespace uplink::bench {

/// The goals that stand beside the figures.
inline constexpr double kAckRatioMax = 1.2;
inline constexpr double kMemoryRatioMax = 1.1;

/// What one window showed. A value.
struct WindowFigures {
  double ack_p50_ms = 0;
  double ack_p99_ms = 0;
  std::uint64_t acks = 0;
  std::uint64_t unacked = 0;
  std::uint64_t cut = 0;
  std::uint64_t rejects = 0;
  std::uint64_t late = 0;
  std::uint64_t unknown = 0;
  std::uint64_t offline = 0;
  /// Of the server; memory is the most that it had.
  double cpu_percent = 0;
  double memory_mib = 0;
  std::uint64_t scrapes = 0;
  std::uint64_t scrapes_failed = 0;
  std::uint64_t law_broken = 0;
};

/// One scenario of one round. A value.
struct FairResult {
  std::string misdeed;
  /// Why the scenario gave no figures; empty if it did.
  std::string failure = {};
  /// It had figures, and the server ended by itself.
  bool server_ended = false;
  WindowFigures without = {};
  WindowFigures with = {};
};

/// All rounds of the scenarios as a table, with the goals and which of them are missed.
/// `share_mib`: memory that the bad robot may have by itself.
[[nodiscard]] std::string FairTable(const std::vector<FairResult>& results, double share_mib);
/// The same for `--json`: rows named SCENARIO_FIGURE.
[[nodiscard]] std::vector<Row> FairRows(const std::vector<FairResult>& results, double share_mib);

}  // namespace uplink::bench
