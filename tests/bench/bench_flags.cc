#include "tests/bench/bench_flags.h"

#include <fmt/core.h>

namespace uplink::bench {

void BenchFlags::AddTo(config::Flags& flags) {
  flags.Add({"--json", "Where the figures go as JSON"}, json);
  flags.Add({"--commit", "What is measured"}, commit);
  flags.Add({"--rounds"}, rounds, {1, 1000});
}

int Publish(const BenchFlags& flags, const std::string& heading, const std::vector<Row>& rows) {
  fmt::print("{}\n{}", heading, TableOf(rows));
  return KeepJson(flags.json, rows, flags.commit) ? 0 : 1;
}

}  // namespace uplink::bench
