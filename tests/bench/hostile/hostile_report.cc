#include "tests/bench/hostile/hostile_report.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "tests/bench/hostile/new_robot.h"

namespace uplink::bench {
namespace {

constexpr double kP99 = 0.99;
constexpr const char* kUndisturbed = "undisturbed";

using Wait = std::optional<milliseconds>;

Wait Worse(const Wait& one, const Wait& other) {
  return one && other ? std::max(one, other) : std::nullopt;
}

void Merge(HostileResult& into, const HostileResult& round) {
  into.server_ended = into.server_ended || round.server_ended;
  into.new_robot_after = Worse(into.new_robot_after, round.new_robot_after);
  into.new_robot_during = Worse(into.new_robot_during, round.new_robot_during);
  for (const double wait : round.ack_ms_without) into.ack_ms_without.push_back(wait);
  for (const double wait : round.ack_ms_with) into.ack_ms_with.push_back(wait);
  into.acked += round.acked;
  into.lost += round.lost;
  into.cut += round.cut;
  into.unacked += round.unacked;
  into.growth_mib = std::max(into.growth_mib, round.growth_mib);
  into.in_log = into.in_log && round.in_log;
  if (round.metric.empty()) into.metric.clear();
}

/// One for each attack, in the order in which they came.
std::vector<HostileResult> LinesOf(const std::vector<HostileResult>& results) {
  std::vector<HostileResult> lines;
  for (const HostileResult& result : results) {
    if (!result.failure.empty()) continue;
    const auto found = std::ranges::find_if(
        lines, [&](const HostileResult& line) { return line.attack == result.attack; });
    if (found == lines.end()) {
      lines.push_back(result);
    } else {
      Merge(*found, result);
    }
  }
  return lines;
}

double P99Without(const HostileResult& line) { return Quantile(line.ack_ms_without, kP99); }
double P99With(const HostileResult& line) { return Quantile(line.ack_ms_with, kP99); }

double RatioOf(const HostileResult& line) {
  const double base = P99Without(line);
  return base == 0 ? 0 : P99With(line) / base;
}

std::string TextOf(const Wait& wait) { return wait ? std::to_string(wait->count()) : "none"; }

std::string MissedBy(const HostileResult& line) {
  std::string missed;
  if (line.server_ended || !line.new_robot_after) missed += " serves";
  if (line.lost + line.unacked > 0) missed += " lost";
  if (line.growth_mib > kGrowthMaxMiB) missed += " memory";
  if (!line.in_log) missed += " log";
  if (line.metric.empty()) missed += " metric";
  if (!line.new_robot_during) missed += " new";
  if (RatioOf(line) > kVictimRatioMax) missed += " ack";
  return missed.empty() ? "-" : missed.substr(1);
}

std::string TextOf(const HostileResult& line) {
  return fmt::format(
      "{:<16} {:>6} {:>5} {:>4} {:>6} {:>7.1f} {:>4} {:<24} {:>6} {:>6} {:>7.2f} {:>7.2f} {:>6.1f} "
      "{}\n",
      line.attack, line.new_robot_after && !line.server_ended ? "yes" : "NO", line.lost, line.cut,
      line.unacked, line.growth_mib, line.in_log ? "yes" : "no",
      line.metric.empty() ? "-" : line.metric, TextOf(line.new_robot_during),
      TextOf(line.new_robot_after), P99Without(line), P99With(line), RatioOf(line), MissedBy(line));
}

std::string TableOf(const std::vector<HostileResult>& lines) {
  std::string text = fmt::format("{:<16} {:>6} {:^17} {:>7} {:^29} {:^13} {:^22}\n", "", "serves",
                                 "victim's", "memory", "named in", "new robot ms", "ack p99 ms");
  text += fmt::format(
      "{:<16} {:>6} {:>5} {:>4} {:>6} {:>7} {:>4} {:<24} {:>6} {:>6} {:>7} {:>7} {:>6} {}\n",
      "attack", "after", "lost", "cut", "unackd", "MiB", "log", "metric", "during", "after", "wo",
      "with", "ratio", "missed");
  for (const HostileResult& line : lines) text += TextOf(line);
  return text;
}

double NumberOf(const Wait& wait) { return wait ? static_cast<double>(wait->count()) : -1; }

void AddRows(const HostileResult& line, std::vector<Row>& rows) {
  const std::string name = line.attack;
  const auto add = [&](const char* figure, const char* unit, double value) {
    rows.push_back(RowOf(name + figure, unit, value));
  };
  Row p99{name + "_ack_p99", "ms", kUndisturbed, {}, {}};
  p99.value.Add(P99With(line));
  p99.comparator_value.Add(P99Without(line));
  rows.push_back(std::move(p99));
  const bool serves = line.new_robot_after && !line.server_ended;
  add("_serves_after", "1: yes", serves ? 1 : 0);
  add("_new_robot_during", "ms", NumberOf(line.new_robot_during));
  add("_new_robot_after", "ms", NumberOf(line.new_robot_after));
  add("_acked", "messages", static_cast<double>(line.acked));
  add("_lost", "messages", static_cast<double>(line.lost));
  add("_unacked", "messages", static_cast<double>(line.unacked));
  add("_cut", "streams", static_cast<double>(line.cut));
  add("_growth", "MiB", line.growth_mib);
  add("_in_log", "1: yes", line.in_log ? 1 : 0);
  add("_in_metric", "1: yes", line.metric.empty() ? 0 : 1);
}

}  // namespace

std::string HostileTable(const std::vector<HostileResult>& results) {
  const std::vector<HostileResult> lines = LinesOf(results);
  std::string text = lines.empty() ? "" : TableOf(lines);
  for (const HostileResult& result : results) {
    if (result.failure.empty()) continue;
    text += fmt::format("{}: no figures: {}\n", result.attack, result.failure);
  }
  return text + fmt::format(
                    "goals: serves afterwards without a restart; nothing lost; at most {} MiB more;"
                    " named in log and metric; new robots within {} s; ack p99 <= {} times\n",
                    kGrowthMaxMiB, std::chrono::duration<double>(kGetsInWithin).count(),
                    kVictimRatioMax);
}

std::vector<Row> HostileRows(const std::vector<HostileResult>& results) {
  std::vector<Row> rows;
  for (const HostileResult& line : LinesOf(results)) AddRows(line, rows);
  return rows;
}

}  // namespace uplink::bench
