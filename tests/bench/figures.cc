#include "tests/bench/figures.h"

#include <algorithm>
#include <fstream>
#include <thread>
#include <utility>

#include <boost/json.hpp>
#include <fmt/core.h>

namespace uplink::bench {
namespace {

std::string CpuModel() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

/// Small figures with more places.
std::string Number(double value) {
  return value < 100 ? fmt::format("{:.2f}", value) : fmt::format("{:.0f}", value);
}

}  // namespace

double Quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  const auto at = static_cast<std::size_t>(share * static_cast<double>(values.size()));
  return values[std::min(at, values.size() - 1)];
}

Row RowOf(std::string scenario, std::string unit, double value) {
  Row row{std::move(scenario), std::move(unit), "", {}, {}};
  row.value.Add(value);
  return row;
}

std::string TableOf(const std::vector<Row>& rows) {
  std::string text =
      fmt::format("{:<28} {:>12} {:>7}  {:<22} {:>12} {:>7}  {:>6}  {}\n", "figure", "value",
                  "spread", "comparator", "value", "spread", "ratio", "unit");
  for (const Row& row : rows) {
    text += fmt::format("{:<28} {:>12} {:>6.0f}%  ", row.scenario, Number(row.value.median()),
                        row.value.spread() * 100);
    if (row.comparator.empty()) {
      text += fmt::format("{:52}  {}\n", "", row.unit);
      continue;
    }
    text += fmt::format("{:<22} {:>12} {:>6.0f}%  {:>6.2f}  {}\n", row.comparator,
                        Number(row.comparator_value.median()), row.comparator_value.spread() * 100,
                        row.ratio(), row.unit);
  }
  return text;
}

std::string JsonOf(const std::vector<Row>& rows, const std::string& commit) {
  boost::json::array list;
  list.reserve(rows.size());
  for (const Row& row : rows) {
    list.push_back({{"scenario", row.scenario},
                    {"value", row.value.median()},
                    {"unit", row.unit},
                    {"comparator", row.comparator},
                    {"comparator_value", row.comparator_value.median()},
                    {"ratio", row.ratio()},
                    {"spread", row.value.spread()}});
  }
  const boost::json::object page{
      {"machine",
       {{"cpu", CpuModel()},
        {"cores", static_cast<std::int64_t>(std::thread::hardware_concurrency())}}},
      {"commit", commit},
      {"rows", list}};
  return boost::json::serialize(page) + "\n";
}

bool KeepJson(const std::string& path, const std::vector<Row>& rows, const std::string& commit) {
  if (path.empty()) return true;
  std::ofstream file(path);
  file << JsonOf(rows, commit) << std::flush;
  if (file) return true;
  fmt::print(stderr, "--json {}: the figures cannot be written there\n", path);
  return false;
}

}  // namespace uplink::bench
