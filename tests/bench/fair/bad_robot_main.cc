// The bad robot of `./dev bench fair`: one robot, one thread, the lowest priority. It says `at
// work` once it is, and what it did when it ends, which it does by itself after --seconds.
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>

#include <absl/status/statusor.h>
#include <fmt/core.h>
#include <sys/prctl.h>
#include <sys/resource.h>

#include "server/config/flags.h"
#include "tests/bench/fair/misbehaviour.h"
#include "tools/uplink-fleet/run/signals.h"

namespace uplink::bench {
namespace {

constexpr milliseconds kTurn{5};
/// What it shares its core with comes first: the robots whose waits are measured.
constexpr int kNice = 19;

struct Arguments {
  std::string misdeed;
  std::string ruri;
  std::string folder;
  std::uint16_t port = 0;
  int seconds = 60;
};

std::string TextOf(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

absl::StatusOr<link::LinkOptions> LinkOf(const Arguments& arguments) {
  link::LinkOptions options;
  auto tls = link::TlsClient::Create(TextOf(arguments.folder + "/ca.crt"), link::Alpn::kHttp2);
  if (!tls.ok()) return tls.status();
  auto identity = link::Identity::Parse(TextOf(arguments.folder + "/bad.crt"),
                                        TextOf(arguments.folder + "/bad.key"));
  if (!identity.ok()) return identity.status();
  auto address = link::Resolve("127.0.0.1:" + std::to_string(arguments.port));
  if (!address.ok()) return address.status();
  options.tls = *std::move(tls);
  options.identity = *std::move(identity);
  options.address = *std::move(address);
  return options;
}

int Misbehave(const Arguments& arguments, const Misdeed& misdeed) {
  const SystemClock clock;
  synthetic::Signals signals(clock);
  auto options = LinkOf(arguments);
  if (!options.ok()) {
    fmt::print(stderr, "{}\n", options.status().ToString());
    return 1;
  }
  link::Loop loop;
  BadCounts counts;
  BadWorld world{loop, clock, *std::move(options), counts};
  const auto bad = misdeed.make(world, arguments.ruri);
  const SteadyTime end = clock.Steady() + std::chrono::seconds(arguments.seconds);
  bool told = false;
  while (!signals.Came() && clock.Steady() < end) {
    if (loop.io.run_one_for(kTurn) == 0) loop.io.restart();
    bad->Act();
    if (told || !bad->at_work()) continue;
    told = true;
    fmt::print("at work\n");
    std::fflush(stdout);
  }
  fmt::print("did: {}\n", counts.Text());
  std::fflush(stdout);
  // What is still connected ends with the process.
  std::_Exit(0);
}

int Run(int argc, char** argv) {
  using Need = config::Flag::Need;
  Arguments arguments;
  config::Flags flags("The bad robot of ./dev bench fair", "uplink_bench_bad_robot");
  flags.Add({"--misdeed", "The scenario's name", Need::kRequired}, arguments.misdeed);
  flags.Add({"--ruri", "Its own", Need::kRequired}, arguments.ruri);
  flags.Add({"--folder", "Holds ca.crt, bad.crt and bad.key", Need::kRequired}, arguments.folder);
  flags.Add({"--port", "Of the relay on loopback", Need::kRequired}, arguments.port);
  flags.Add({"--seconds", "It ends after so many"}, arguments.seconds, {1, 3600});
  if (const auto code = flags.Parse(argc, argv)) return *code;
  const Misdeed* const misdeed = MisdeedOf(arguments.misdeed);
  if (misdeed == nullptr) {
    fmt::print(stderr, "unknown misdeed: {}\n", arguments.misdeed);
    return 2;
  }
  return Misbehave(arguments, *misdeed);
}

}  // namespace
}  // namespace uplink::bench

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);
  // It does not outlive who started it, however that ends.
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  setpriority(PRIO_PROCESS, 0, uplink::bench::kNice);
  return uplink::bench::Run(argc, argv);
}
