// Days of a fleet in seconds: what is in the store at the end of each.
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "tests/simulation/days.h"

int main(int argc, char** argv) {
  uplink::simulation::DaysOptions options;
  CLI::App app("Days of presence, expiry and retention by a manual clock", "uplink_simulate_days");
  app.add_option("--days", options.days)->check(CLI::Range(1, 250));
  app.add_option("--robots", options.robots)->check(CLI::Range(1, 100));
  app.add_option("--history-days", options.history_days)->check(CLI::Range(1, 365));
  app.add_option("--quarantine-days", options.quarantine_days)->check(CLI::Range(1, 365));
  CLI11_PARSE(app, argc, argv);
  const auto days = uplink::simulation::Days(options).Run();
  fmt::print("{:>5}", "day");
  for (const auto& [table, rows] : days.front().rows) fmt::print(" {:>16}", table);
  fmt::print(" {:>9}\n", "file KiB");
  for (const auto& day : days) {
    fmt::print("{:>5}", day.day + 1);
    for (const auto& [table, rows] : day.rows) fmt::print(" {:>16}", rows);
    fmt::print(" {:>9}\n", day.file_kib);
  }
  return 0;
}
