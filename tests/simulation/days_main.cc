// Days of a fleet in seconds: what is in the store at the end of each.
#include <string>

#include <fmt/core.h>

#include "server/config/flags.h"
#include "tests/simulation/days.h"

int main(int argc, char** argv) {
  uplink::simulation::DaysOptions options;
  uplink::config::Flags flags("Days of presence, expiry and retention by a manual clock",
                              "uplink_simulate_days");
  flags.Add({"--days"}, options.days, {1, 250});
  flags.Add({"--robots"}, options.robots, {1, 100});
  flags.Add({"--history-days"}, options.history_days, {1, 365});
  flags.Add({"--quarantine-days"}, options.quarantine_days, {1, 365});
  if (const auto code = flags.Parse(argc, argv)) return *code;
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
