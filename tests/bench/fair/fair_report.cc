#include "tests/bench/fair/fair_report.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

namespace uplink::bench {
namespace {

constexpr const char* kWithout = "without it";

/// A figure in all rounds of a scenario.
struct Both {
  Rounds without;
  Rounds with;

  [[nodiscard]] double ratio() const {
    return without.median() == 0 ? 0 : with.median() / without.median();
  }
};

/// All rounds of a scenario.
struct Line {
  Both p50, p99, cpu, memory;
  /// The sum of both windows, except what the bad robot may have caused: that of the second.
  std::uint64_t unknown = 0, offline = 0, cut = 0, unacked = 0, rejects = 0, late = 0;
  std::uint64_t before = 0;
  std::uint64_t scrapes = 0, scrapes_failed = 0, law_broken = 0;
  std::uint64_t server_ended = 0;

  void Add(const FairResult& result);
  /// What the goal leaves the server.
  [[nodiscard]] double memory_max(double share_mib) const {
    return kMemoryRatioMax * memory.without.median() + share_mib;
  }
};

void AddTo(Both& both, double without, double with) {
  both.without.Add(without);
  both.with.Add(with);
}

void Line::Add(const FairResult& result) {
  const WindowFigures& a = result.without;
  const WindowFigures& b = result.with;
  AddTo(p50, a.ack_p50_ms, b.ack_p50_ms);
  AddTo(p99, a.ack_p99_ms, b.ack_p99_ms);
  AddTo(cpu, a.cpu_percent, b.cpu_percent);
  AddTo(memory, a.memory_mib, b.memory_mib);
  unknown += b.unknown;
  offline += b.offline;
  cut += b.cut;
  unacked += b.unacked;
  rejects += b.rejects;
  late += a.late + b.late;
  before += a.unknown + a.offline + a.cut + a.unacked + a.rejects;
  scrapes += a.scrapes + b.scrapes;
  scrapes_failed += a.scrapes_failed + b.scrapes_failed;
  law_broken += a.law_broken + b.law_broken;
  server_ended += result.server_ended ? 1 : 0;
}

/// By their misdeeds, in the order in which they came.
std::vector<std::pair<std::string, Line>> LinesOf(const std::vector<FairResult>& results) {
  std::vector<std::pair<std::string, Line>> lines;
  for (const FairResult& result : results) {
    if (!result.failure.empty()) continue;
    auto line = std::ranges::find(lines, result.misdeed, &std::pair<std::string, Line>::first);
    if (line == lines.end()) line = lines.emplace(lines.end(), result.misdeed, Line());
    line->second.Add(result);
  }
  return lines;
}

std::string MissedBy(const Line& line, double share_mib) {
  std::string missed;
  if (line.p99.ratio() > kAckRatioMax) missed += " ack";
  if (line.unknown + line.offline > 0) missed += " presence";
  if (line.memory.with.median() > line.memory_max(share_mib)) missed += " memory";
  if (line.law_broken > 0) missed += " law";
  if (line.server_ended > 0) missed += " server";
  return missed.empty() ? "-" : missed.substr(1);
}

std::string TextOf(const std::string& misdeed, const Line& line, double share_mib) {
  std::string text = fmt::format(
      "{:<10} {:>7.1f} {:>7.1f} {:>8.1f} {:>8.1f} {:>6.2f} {:>5} {:>5} {:>5} {:>6} {:>5.0f} "
      "{:>5.0f} {:>6.2f} {:>6.0f} {:>6.0f} {:>6.0f} {:>4}/{:<4} {}\n",
      misdeed, line.p50.without.median(), line.p50.with.median(), line.p99.without.median(),
      line.p99.with.median(), line.p99.ratio(), line.unknown, line.offline, line.cut, line.unacked,
      line.cpu.without.median(), line.cpu.with.median(), line.cpu.ratio(),
      line.memory.without.median(), line.memory.with.median(), line.memory_max(share_mib),
      line.law_broken, line.scrapes, MissedBy(line, share_mib));
  const auto add = [&](std::uint64_t count, std::string_view what) {
    if (count > 0) text += fmt::format("{:<10} {} {}\n", "", count, what);
  };
  add(line.server_ended, "times the server ended by itself");
  add(line.late, "messages left late: the load itself was slow");
  add(line.rejects, "messages of well-behaved robots were rejected");
  add(line.before, "robots unknown, offline or cut, or messages unacked or rejected, without it");
  add(line.scrapes_failed, "requests over HTTP failed");
  return text;
}

Row RowOf(std::string name, std::string unit, const Both& both) {
  return {std::move(name), std::move(unit), kWithout, both.with, both.without};
}

}  // namespace

std::string FairTable(const std::vector<FairResult>& results, double share_mib) {
  std::string text =
      fmt::format("{:<10} {:>15} {:>24} {:>11} {:>12} {:>18} {:>20} {:>9}\n", "", "ack p50 ms",
                  "ack p99 ms", "shown as", "", "server CPU %", "memory MiB", "law");
  text += fmt::format(
      "{:<10} {:>7} {:>7} {:>8} {:>8} {:>6} {:>5} {:>5} {:>5} {:>6} {:>5} {:>5} {:>6} {:>6} {:>6} "
      "{:>6} {:>9} {}\n",
      "scenario", "wo", "with", "wo", "with", "ratio", "unkn", "offl", "cut", "unackd", "wo",
      "with", "ratio", "wo", "with", "max", "broken/of", "missed");
  for (const auto& [misdeed, line] : LinesOf(results)) text += TextOf(misdeed, line, share_mib);
  for (const FairResult& result : results) {
    if (!result.failure.empty()) {
      text += fmt::format("{:<10} no figures: {}\n", result.misdeed, result.failure);
    }
  }
  return text + fmt::format(
                    "goals: ack p99 <= {} times; none unknown or offline; memory <= {} "
                    "times and {} MiB; the law at every scrape\n",
                    kAckRatioMax, kMemoryRatioMax, share_mib);
}

std::vector<Row> FairRows(const std::vector<FairResult>& results, double share_mib) {
  std::vector<Row> rows;
  for (const auto& [name, line] : LinesOf(results)) {
    const auto count = [&rows, &name = name](const char* figure, const char* unit, double value) {
      rows.push_back(RowOf(name + figure, unit, value));
    };
    rows.push_back(RowOf(name + "_ack_p50", "ms", line.p50));
    rows.push_back(RowOf(name + "_ack_p99", "ms", line.p99));
    rows.push_back(RowOf(name + "_cpu", "% of a core", line.cpu));
    rows.push_back(RowOf(name + "_memory", "MiB", line.memory));
    count("_memory_max", "MiB", line.memory_max(share_mib));
    count("_unknown", "robots", static_cast<double>(line.unknown));
    count("_offline", "robots", static_cast<double>(line.offline));
    count("_cut", "streams", static_cast<double>(line.cut));
    count("_unacked", "messages", static_cast<double>(line.unacked));
    count("_scrapes", "scrapes", static_cast<double>(line.scrapes));
    count("_law_broken", "scrapes", static_cast<double>(line.law_broken));
    count("_late", "messages", static_cast<double>(line.late));
  }
  return rows;
}

}  // namespace uplink::bench
