#include "tests/bench/trouble_flags.h"

namespace uplink::bench {
namespace {

void AddTo(config::Flags& parser, const std::vector<std::string>& scenarios,
           const config::FlagRange& robots, TroubleFlags& flags) {
  flags.AddTo(parser);
  parser.AddChoices({"--only", "Scenarios; all if none is named"}, flags.only, scenarios);
  parser.Add({"--server-bin", "The uplinkd that is measured; this build's if none is named"},
             flags.server_bin);
  parser.Add({"--robots", "Well-behaved ones"}, flags.robots, robots);
}

}  // namespace

std::optional<int> ParseFairFlags(int argc, const char* const* argv,
                                  const std::vector<std::string>& scenarios, FairFlags& flags) {
  config::Flags parser("Well-behaved robots beside one that is not", "uplink_bench_fair");
  AddTo(parser, scenarios, {1, 5000}, flags);
  parser.AddChoice({"--store"}, flags.store, {"sqlite", "postgres"});
  parser.Add({"--seconds", "Of each of the two windows of a scenario"}, flags.seconds,
             kSecondsRange);
  parser.Add({"--share-mib", "Memory that the bad robot may add beside a tenth"}, flags.share_mib,
             {0, 1'000'000});
  return parser.Parse(argc, argv);
}

std::optional<int> ParseHostileFlags(int argc, const char* const* argv,
                                     const std::vector<std::string>& scenarios,
                                     HostileFlags& flags) {
  config::Flags parser("A server under attack, beside an honest robot", "uplink_bench_hostile");
  AddTo(parser, scenarios, {1, 100}, flags);
  parser.Add({"--seconds", "Without the attack and with it; some attacks need more"}, flags.seconds,
             kSecondsRange);
  return parser.Parse(argc, argv);
}

}  // namespace uplink::bench
