// What hostile clients do to a server: attacks one by one, each on a server and
// a store of its own, beside an honest robot. The server has one core, everybody else the other.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <future>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <sys/resource.h>
#include <unistd.h>

#include "tests/bench/hostile/attack.h"
#include "tests/bench/hostile/hostile_report.h"
#include "tests/bench/hostile/new_robot.h"
#include "tests/bench/hostile/traces.h"
#include "tests/bench/trouble.h"
#include "tests/bench/trouble_flags.h"
#include "tests/support/sqlite_shell.h"
#include "tools/link/http_client.h"
#include "tools/uplink-fleet/run/signals.h"

namespace uplink::bench {
namespace {

constexpr milliseconds kConnectWait{20'000};
constexpr milliseconds kWarmUp{1'000};
/// The attack is at its height.
constexpr milliseconds kNewRobotAfter{2'000};
/// The robot whose waits are measured comes first.
constexpr int kNice = 19;
/// The honest robots send twenty durable messages per second each.
constexpr Others::Rhythm kRhythm{.messages_per_second = 20};
constexpr const char* kVictimRuri = "rcan://bench.local/robots/victim";

testing::KeyPair Issued(const World& world, const std::string& ruri) {
  return world.folder.authority().Issue(testing::RobotSpec(ruri));
}

std::vector<link::Identity> VictimsOf(const World& world, std::size_t robots) {
  std::vector<link::Identity> victims;
  for (std::size_t i = 0; i < robots; ++i) {
    const std::string ruri = i == 0 ? kVictimRuri : fmt::format("{}{}", kVictimRuri, i + 1);
    victims.push_back(world.Issue(testing::RobotSpec(ruri)));
  }
  return victims;
}

/// Messages of the victim up to that number that the store does not have; `session` in hex.
std::uint64_t Missing(const std::string& store, const std::string& session, std::uint64_t acked) {
  const std::string rows = testing::SqliteShell(store).Read(
      fmt::format("SELECT count(DISTINCT seq) FROM events WHERE ruri = '{}' AND session = x'{}' AND"
                  " seq BETWEEN 1 AND {}",
                  kVictimRuri, session, acked));
  return acked - std::min<std::uint64_t>(acked, std::stoull(rows));
}

/// A new robot on its way in.
using Arrival = std::future<std::optional<milliseconds>>;

class Measurement final {
 public:
  Measurement(const TroubleRun& run, const Attack& attack, PinnedServer& server)
      : run_(run),
        attack_(attack),
        server_(server),
        http_(fmt::format("127.0.0.1:{}", server.ports().http)),
        scene_(run, server, kRhythm) {}

  /// What the server's store is asked for is left out.
  void Measure(HostileResult& result) {
    const std::vector<link::Identity> identities = VictimsOf(run_.world, run_.robots);
    if (victims().Connect(identities, identities.size(), kConnectWait) < identities.size()) {
      result.failure = "the victim was not welcomed";
      return;
    }
    static_cast<void>(For(kWarmUp));
    result.ack_ms_without = For(run_.window).ack_ms;
    if (server_.ended() || run_.stopped()) {
      result.failure = "the server ended, or the run was stopped, before the attack began";
      return;
    }
    const auto counted = Scraped();
    result.memory_mib = MemoryMiB();
    Attacked(result);
    Recovers(result);
    result.growth_mib = std::max(0.0, scene_.memory_max_mib() - result.memory_mib);
    const auto counts = Scraped();
    if (counted && counts) result.metric = GrownMost(*counted, *counts);
    result.acked = victims().first().settled_seq();
    if (run_.stopped()) result.failure = "stopped";
  }

  /// Of the first victim, in hex.
  [[nodiscard]] std::string session() { return victims().first().session().ToHex(); }

 private:
  double MemoryMiB() const { return static_cast<double>(server_.use().rss_bytes) / kMiB; }

  OthersTally For(milliseconds time) { return victims().Measure(scene_.For(time)); }

  Arrival Send(const std::string& name) {
    NewRobot robot{.port = server_.ports().relay,
                   .server_ca = run_.world.folder.authority().certificate(),
                   .identity = Issued(run_.world, "rcan://bench.local/robots/" + name)};
    return std::async(std::launch::async, [this, robot = std::move(robot)] {
      return TimeToGetIn(robot, scene_.clock());
    });
  }

  static bool IsOver(const auto& future) {
    return future.wait_for(milliseconds(0)) == std::future_status::ready;
  }

  void Attacked(HostileResult& result) {
    const SteadyTime began = scene_.clock().Steady();
    const milliseconds lasts = std::max(run_.window, milliseconds(attack_.time_min));
    AttackSite site{.clock = scene_.clock(),
                    .port = server_.ports().relay,
                    .server_ca = run_.world.folder.authority().certificate(),
                    .identity = Issued(run_.world, std::string(kAttackerRuri)),
                    .until = began + lasts};
    const auto attacker = std::async(std::launch::async, [this, site = std::move(site)] {
      setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNice);
      attack_.run(site);
    });
    scene_.ForgetMemory();
    std::optional<Arrival> arrival;
    const SteadyTime height = began + std::min(kNewRobotAfter, lasts / 2);
    const OthersTally tally = victims().Measure([&] {
      if (!arrival && scene_.clock().Steady() >= height) arrival = Send("new");
      return scene_.Turn() &&
             !(arrival && IsOver(attacker) && scene_.clock().Steady() >= began + lasts);
    });
    result.ack_ms_with = tally.ack_ms;
    result.cut = tally.cut;
    result.unacked = tally.unacked;
    attacker.wait();
    if (arrival) result.new_robot_during = arrival->get();
  }

  void Recovers(HostileResult& result) {
    Arrival arrival = Send("newer");
    const OthersTally tally = victims().Measure([&] { return scene_.Turn() && !IsOver(arrival); });
    result.new_robot_after = arrival.get();
    result.cut += tally.cut;
    // What had no Ack during the attack may have one by now.
    result.unacked = tally.unacked;
  }

  std::optional<Samples> Scraped() {
    const auto page = http_.Get("/metrics");
    if (page.ok()) return SamplesOf(*page);
    run_.say("  a request failed: " + page.status().ToString());
    return std::nullopt;
  }

  [[nodiscard]] Others& victims() { return scene_.others(); }

  const TroubleRun& run_;
  const Attack& attack_;
  PinnedServer& server_;
  link::HttpClient http_;
  Scene scene_;
};

HostileResult Measured(const TroubleRun& run, const Attack& attack) {
  run.say(fmt::format("{}: {}", attack.name, attack.about));
  HostileResult result{.attack = std::string(attack.name)};
  const FreshFile store(run.world.folder.Path("hostile.db"));
  auto server = StartServer(run, store.url(), attack.descriptors_max);
  if (!server.ok()) {
    result.failure = std::string(server.status().message());
    return result;
  }
  std::string session;
  {
    Measurement measurement(run, attack, **server);
    measurement.Measure(result);
    session = measurement.session();
  }
  result.server_ended = (*server)->ended();
  run.say("  the server: " + (*server)->Stop());
  const std::string_view line = LineThatNames((*server)->log());
  result.in_log = !line.empty();
  if (result.in_log) run.say("  its log: " + std::string(line));
  result.lost = Missing(store.path(), session, result.acked);
  return result;
}

int Run(int argc, char** argv) {
  HostileFlags flags;
  if (const auto code = ParseHostileFlags(argc, argv, NamesOf(Attacks()), flags)) return *code;
  const SystemClock clock;
  synthetic::Signals signals(clock);
  bool stopped = false;
  const bool apart = PinTo(kLoadCore);
  const World world;
  const TroubleRun run{.world = world,
                       .server_bin = flags.server_bin.empty() ? UPLINKD_PROGRAM : flags.server_bin,
                       .window = std::chrono::seconds(flags.seconds),
                       .robots = static_cast<std::size_t>(flags.robots),
                       .stopped = [&] { return stopped = stopped || signals.Came(); },
                       .say = Say};
  std::vector<HostileResult> results;
  for (int round = 0; round < flags.rounds; ++round) {
    for (const Attack* attack : ChosenOf(Attacks(), flags.only)) {
      if (run.stopped()) break;
      results.push_back(Measured(run, *attack));
      fmt::print(stderr, "{}", HostileTable({results.back()}));
    }
  }
  fmt::print(
      "hostile: {} with 20 durable messages per second each, the server on {}; {} rounds, {} s"
      " without each attack and at least as long with it\n{}",
      flags.robots == 1 ? "one robot" : fmt::format("{} robots", flags.robots),
      apart ? "a core of its own" : "the only core", flags.rounds, flags.seconds,
      HostileTable(results));
  const bool kept = KeepJson(flags.json, HostileRows(results), flags.commit);
  const bool measured = std::ranges::any_of(
      results, [](const HostileResult& result) { return result.failure.empty(); });
  return measured && kept && !stopped ? 0 : 1;
}

}  // namespace
}  // namespace uplink::bench

int main(int argc, char** argv) {
  uplink::bench::PrepareLoad();
  return uplink::bench::Run(argc, argv);
}
