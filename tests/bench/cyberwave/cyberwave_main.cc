// What it costs to read a fleet's MQTT broker, beside readers that do nothing with it, in one run.
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "tests/bench/cyberwave/scenarios.h"
#include "tests/bench/figures.h"
#include "tests/bench/world.h"
#include "tests/support/flags.h"

namespace uplink::bench {
namespace {

struct Arguments {
  std::string url;
  std::string json;
  std::string commit = "unknown";
  std::string only;
  int rounds = 3;
  int seconds = 5;
};

struct Scenario {
  std::string name;
  std::function<std::vector<Row>(const CyberwaveRun&)> measure;
};

std::vector<Row> RowsOf(const Arguments& arguments) {
  const std::vector<Scenario> scenarios = {{"joints", MeasureJoints},
                                           {"events", MeasureEvents},
                                           {"ack", MeasureAcks},
                                           {"depth", MeasureDepth}};
  const SystemClock clock;
  const CyberwaveRun run{.clock = clock,
                         .postgres_url = arguments.url,
                         .rounds = arguments.rounds,
                         .seconds = arguments.seconds};
  std::vector<Row> rows;
  for (const Scenario& scenario : scenarios) {
    if (!arguments.only.empty() && arguments.only != scenario.name) continue;
    fmt::print(stderr, "cyberwave: {}\n", scenario.name);
    for (Row& row : scenario.measure(run)) rows.push_back(std::move(row));
  }
  return rows;
}

int Run(int argc, char** argv) {
  Arguments arguments;
  constexpr auto kRequired = testing::Flag::Need::kRequired;
  testing::Flags flags("Benchmark of reading a fleet's MQTT broker", "uplink_bench_cyberwave");
  flags.Add({"--url", "A migrated PostgreSQL database", kRequired}, arguments.url);
  flags.Add({"--json", "Where the figures go as JSON"}, arguments.json);
  flags.Add({"--commit", "What is measured"}, arguments.commit);
  flags.AddChoice({"--only", "One scenario"}, arguments.only, {"joints", "events", "ack", "depth"});
  flags.Add({"--rounds"}, arguments.rounds, {1, 100});
  flags.Add({"--seconds"}, arguments.seconds, {1, 600});
  if (const auto code = flags.Parse(argc, argv)) return *code;
  const bool apart = PinTo(kLoadCore);
  const std::vector<Row> rows = RowsOf(arguments);
  fmt::print(
      "cyberwave: who reads on {}, broker and publishers on {}, PostgreSQL on any; {} rounds of {} "
      "s\n{}",
      apart ? "a core of its own" : "the only core", apart ? "another" : "it", arguments.rounds,
      arguments.seconds, TableOf(rows));
  return KeepJson(arguments.json, rows, arguments.commit) ? 0 : 1;
}

}  // namespace
}  // namespace uplink::bench

int main(int argc, char** argv) {
  uplink::bench::PrepareLoad();
  return uplink::bench::Run(argc, argv);
}
