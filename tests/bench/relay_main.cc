// What a message, a connection and a byte of state cost uplinkd, beside bare servers and brokers
// that do less, in one run. Servers have one core, the load has the other.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "schema/base/check.h"
#include "tests/bench/bench_flags.h"
#include "tests/bench/servers.h"

namespace uplink::bench {
namespace {

using std::chrono::seconds;

struct Arguments : BenchFlags {
  Arguments() : BenchFlags{.rounds = 3, .seconds = 3} {}

  std::string what = "relay";
  std::vector<std::string> only;
};

constexpr double kMicrosPerSecond = 1e6;
constexpr double kBytesAKiB = 1024;
constexpr int kWarmUpSeconds = 1;
/// Share of a core above which a server had no more of it.
constexpr double kFullCore = 0.97;
/// Handshakes at a time while nothing is measured.
constexpr std::size_t kConnectsAtOnce = 32;

// The load of the scenarios.
constexpr std::size_t kPacedRobots = 2000;
constexpr double kPacedHz = 10;
constexpr std::size_t kFewerRobots = 500;
/// Through which the paced robots speak.
constexpr std::size_t kGateways = 20;
constexpr std::size_t kFloodRobots = 16;
/// Messages that a flooding robot has on its way.
constexpr std::size_t kFloodAhead = 2048;
constexpr std::size_t kIdleRobots = 5000;
constexpr std::size_t kFewRobots = 100;
constexpr std::size_t kManyRobots = 10'000;
constexpr double kGrowthRate = 10'000;
constexpr std::size_t kMemoryRobots = 2000;
static_assert(kMemoryRobots == kPacedRobots, "KiBPerRobot is of both");
constexpr std::size_t kMemoryMessages = 64;
constexpr std::size_t kAcceptRobots = 2000;
constexpr std::size_t kStormRobots = 5000;
constexpr std::size_t kStormAtOnce = 256;

using Kinds = std::vector<ServerKind>;
const Kinds kAll = {ServerKind::kGrpcSink, ServerKind::kTlsSink, ServerKind::kMosquitto,
                    ServerKind::kNats};
const Kinds kEach = {ServerKind::kUplinkd, ServerKind::kGrpcSink, ServerKind::kTlsSink,
                     ServerKind::kMosquitto, ServerKind::kNats};
const Kinds kSinks = {ServerKind::kGrpcSink, ServerKind::kTlsSink};
const Kinds kBareGrpc = {ServerKind::kGrpcSink};

class RelayBench final {
 public:
  explicit RelayBench(const Arguments& arguments) : arguments_(arguments) {}

  std::vector<Row> Run() {
    if (arguments_.what == "relay") {
      Cost("paced_1", kAll, 1, kPacedRobots, Paced(kPacedRobots * kPacedHz, 1));
      Cost("paced_500_robots", kBareGrpc, 1, kFewerRobots, Paced(kFewerRobots * kPacedHz, 1));
      Cost("paced_10", kSinks, 10, kPacedRobots, Paced(kPacedRobots, 10));
      Cost("flood_1", kAll, 1, kFloodRobots, Flooding(1));
      Cost("flood_64", kSinks, 64, kFloodRobots, Flooding(64));
      Cost("connected_5000_1hz", kBareGrpc, 1, kIdleRobots, Paced(kIdleRobots, 1));
      Growth();
      Gateways();
    } else if (arguments_.what == "memory") {
      Memory();
    } else {
      Accepts();
      Storm();
    }
    return std::move(rows_);
  }

 private:
  using Act = std::function<void(Load&, milliseconds)>;

  static Act Paced(double frames_per_second, std::size_t frame_messages) {
    return [=](Load& load, milliseconds duration) {
      load.Pace(frames_per_second, frame_messages, duration);
    };
  }
  static Act Flooding(std::size_t frame_messages) {
    return [=](Load& load, milliseconds duration) {
      load.Flood(kFloodAhead, frame_messages, duration);
    };
  }

  [[nodiscard]] bool Wanted(const std::string& scenario) const {
    return arguments_.only.empty() ||
           std::ranges::find(arguments_.only, scenario) != arguments_.only.end();
  }

  static void Say(const std::string& text) { fmt::print(stderr, "{}\n", text); }

  /// uplinkd beside each of the others that was measured.
  void AddRows(const std::string& scenario, const std::string& unit,
               const std::map<ServerKind, Rounds>& figures) {
    for (const auto& [kind, its] : figures) {
      if (kind == ServerKind::kUplinkd) continue;
      rows_.push_back({scenario, unit, NameOf(kind), figures.at(ServerKind::kUplinkd), its});
    }
  }

  /// A fresh server of each kind that is installed, and robots for it, in each round.
  void OnFreshServers(const std::string& scenario,
                      const std::function<void(ServerKind, const Server&, Load&)>& act) {
    for (int round = 0; round < arguments_.rounds; ++round) {
      for (const ServerKind kind : kEach) {
        if (!IsInstalled(kind)) continue;
        Say(scenario + ": " + NameOf(kind));
        const Server server(world_, kind);
        link::Loop loop;
        Load load(server.where(), loop);
        act(kind, server, load);
      }
    }
  }

  /// Microseconds of the server's CPU for each message of one window.
  double CostOnce(const Server& server, Load& load, const Act& act) {
    act(load, seconds(kWarmUpSeconds));
    const synthetic::ProcessUse before = server.use();
    const std::uint64_t acked = load.acked();
    const std::uint64_t sent = load.sent();
    act(load, seconds(arguments_.seconds));
    const double cpu = server.use().Since(before).cpu_seconds;
    // Acks lag behind by less than a message in a hundred; a flood has as many on its way at its
    // end as at its beginning.
    const double messages = static_cast<double>(std::max(load.acked() - acked, load.sent() - sent));
    full_core_ = cpu > kFullCore * arguments_.seconds;
    return cpu * kMicrosPerSecond / std::max(messages, 1.0);
  }

  /// As CostOnce, where messages come at a rate whether the server keeps up or not.
  double PacedCostOnce(const std::string& scenario, const Server& server, Load& load,
                       const Act& act) {
    const double cost = CostOnce(server, load, act);
    if (full_core_) {
      Say(scenario + ": the server's core was full: a message costs at least this much");
    }
    return cost;
  }

  /// The server under test, and then each comparator, one after the other.
  void Cost(const std::string& scenario, const Kinds& comparators, std::size_t frame_messages,
            std::size_t robots, const Act& act) {
    if (!Wanted(scenario)) return;
    world_.MakeRobots(robots);
    Kinds kinds = {ServerKind::kUplinkd};
    for (const ServerKind kind : comparators) {
      if (IsInstalled(kind)) kinds.push_back(kind);
    }
    link::Loop loop;
    std::vector<std::unique_ptr<Server>> servers;
    std::vector<std::unique_ptr<Load>> loads;
    for (const ServerKind kind : kinds) {
      Say(scenario + ": " + std::to_string(robots) + " robots of " + NameOf(kind));
      servers.push_back(std::make_unique<Server>(world_, kind, frame_messages));
      loads.push_back(std::make_unique<Load>(servers.back()->where(), loop));
      loads.back()->ConnectUpTo(robots, kConnectsAtOnce);
    }
    const bool flood = scenario.starts_with("flood");
    std::map<ServerKind, Rounds> costs;
    for (int round = 0; round < arguments_.rounds; ++round) {
      for (std::size_t i = 0; i < servers.size(); ++i) {
        costs[kinds[i]].Add(flood ? CostOnce(*servers[i], *loads[i], act)
                                  : PacedCostOnce(scenario + " of " + NameOf(kinds[i]), *servers[i],
                                                  *loads[i], act));
      }
    }
    AddRows(scenario, "us CPU/message", costs);
    for (std::size_t i = 0; i < loads.size(); ++i) {
      if (loads[i]->late() > 0) {
        Say(fmt::format("{}: the load itself was late for {}: {} frames", scenario,
                        NameOf(kinds[i]), loads[i]->late()));
      }
    }
  }

  /// A server with few robots and one with many, for Growth.
  struct Pair {
    Pair(World& world, ServerKind kind, link::Loop& loop)
        : few_server(world, kind),
          many_server(world, kind),
          few(few_server.where(), loop),
          many(many_server.where(), loop) {
      few.ConnectUpTo(kFewRobots, kConnectsAtOnce);
      many.ConnectUpTo(kManyRobots, kConnectsAtOnce);
    }

    Server few_server;
    Server many_server;
    Load few;
    Load many;
  };

  /// Cost of a message with many robots over that with few, at the same rate of all.
  void Growth() {
    const std::string scenario = "growth_100_to_10000";
    if (!Wanted(scenario)) return;
    world_.MakeRobots(kManyRobots);
    struct Costs {
      Rounds few;
      Rounds many;
      Rounds growth;
    };
    std::map<ServerKind, Costs> costs;
    const Kinds kinds = {ServerKind::kUplinkd, ServerKind::kGrpcSink, ServerKind::kTlsSink};
    const Act act = Paced(kGrowthRate, 1);
    // One kind after the other: twenty thousand connections are more than a user may have.
    for (const ServerKind kind : kinds) {
      Say(scenario + ": " + NameOf(kind));
      link::Loop loop;
      Pair pair(world_, kind, loop);
      for (int round = 0; round < arguments_.rounds; ++round) {
        const double few = PacedCostOnce(scenario, pair.few_server, pair.few, act);
        const double many = PacedCostOnce(scenario, pair.many_server, pair.many, act);
        costs[kind].few.Add(few);
        costs[kind].many.Add(many);
        costs[kind].growth.Add(many / few);
      }
    }
    const Costs& own = costs[ServerKind::kUplinkd];
    for (std::size_t i = 1; i < kinds.size(); ++i) {
      const std::string name = NameOf(kinds[i]);
      const Costs& its = costs[kinds[i]];
      rows_.push_back({"robots_100_at_10000_a_second", "us CPU/message", name, own.few, its.few});
      rows_.push_back(
          {"robots_10000_at_10000_a_second", "us CPU/message", name, own.many, its.many});
      rows_.push_back({scenario, "x", name, own.growth, its.growth});
    }
  }

  /// The same robots through gateways and by themselves: what a message costs, and what a robot
  /// holds once it has live state.
  void Gateways() {
    const std::string scenario = "gateways_20x100";
    if (!Wanted(scenario)) return;
    world_.MakeRobots(kPacedRobots);
    const std::vector<link::Identity> gateways = world_.MakeGateways(kGateways, kPacedRobots);
    const std::string by_itself = "connections of their own";
    Row cost{scenario, "us CPU/message", by_itself, {}, {}};
    Row memory{scenario + "_memory", "KiB/robot", by_itself, {}, {}};
    const Act act = Paced(kPacedRobots * kPacedHz, 1);
    for (int round = 0; round < arguments_.rounds; ++round) {
      for (const bool through : {true, false}) {
        Say(scenario + (through ? ": through gateways" : ": by themselves"));
        const Server server(world_, ServerKind::kUplinkd);
        Load::Where where = server.where();
        if (through) where.gateways = gateways;
        link::Loop loop;
        Load load(std::move(where), loop);
        const std::uint64_t before = server.use().rss_bytes;
        load.ConnectUpTo(kPacedRobots, kConnectsAtOnce);
        load.SendEach(kMemoryMessages);
        (through ? memory.value : memory.comparator_value)
            .Add(KiBPerRobot(server.use().rss_bytes - before));
        (through ? cost.value : cost.comparator_value)
            .Add(PacedCostOnce(scenario, server, load, act));
      }
    }
    rows_.push_back(std::move(cost));
    rows_.push_back(std::move(memory));
  }

  /// Resident memory that a robot adds: connected, and after some messages with its live state.
  void Memory() {
    world_.MakeRobots(kMemoryRobots);
    std::map<ServerKind, Rounds> idle;
    std::map<ServerKind, Rounds> used;
    OnFreshServers("memory", [&](ServerKind kind, const Server& server, Load& load) {
      const std::uint64_t before = server.use().rss_bytes;
      load.ConnectUpTo(kMemoryRobots, kConnectsAtOnce);
      idle[kind].Add(KiBPerRobot(server.use().rss_bytes - before));
      load.SendEach(kMemoryMessages);
      used[kind].Add(KiBPerRobot(server.use().rss_bytes - before));
    });
    AddRows("memory_connected", "KiB/robot", idle);
    AddRows("memory_after_64_messages", "KiB/robot", used);
  }

  static double KiBPerRobot(std::uint64_t bytes) {
    return static_cast<double>(bytes) / kBytesAKiB / static_cast<double>(kMemoryRobots);
  }

  /// Connections with their whole handshake, and a stream, for each second of the server's CPU.
  void Accepts() {
    if (!Wanted("accepts")) return;
    world_.MakeRobots(kAcceptRobots);
    std::map<ServerKind, Rounds> rates;
    OnFreshServers("accepts", [&](ServerKind kind, const Server& server, Load& load) {
      const synthetic::ProcessUse before = server.use();
      load.ConnectUpTo(kAcceptRobots, kConnectsAtOnce);
      rates[kind].Add(static_cast<double>(kAcceptRobots) / server.use().Since(before).cpu_seconds);
    });
    AddRows("accepts", "1/s of a core", rates);
  }

  /// A server that is killed under its robots: until all stream again to the next one.
  void Storm() {
    if (!Wanted("reconnect_5000")) return;
    world_.MakeRobots(kStormRobots);
    Row row{"reconnect_5000", "s", "", {}, {}};
    Server server(world_, ServerKind::kUplinkd);
    link::Loop loop;
    Load load(server.where(), loop);
    load.ConnectUpTo(kStormRobots, kConnectsAtOnce);
    load.SendEach(1);
    const SystemClock clock;
    for (int round = 0; round < arguments_.rounds; ++round) {
      Say("reconnect_5000");
      const SteadyTime began = clock.Steady();
      server.KillAndStart();
      UPLINK_CHECK(load.ConnectAgain(kStormAtOnce, std::chrono::minutes(2)),
                   "all robots stream again");
      row.value.Add(std::chrono::duration<double>(clock.Steady() - began).count());
      load.SendEach(1);
    }
    rows_.push_back(std::move(row));
  }

  const Arguments& arguments_;
  World world_;
  /// In the last window.
  bool full_core_ = false;
  std::vector<Row> rows_;
};

int Run(int argc, char** argv) {
  Arguments arguments;
  config::Flags flags("Benchmarks of the relay", "uplink_bench_relay");
  flags.AddChoice({"what"}, arguments.what, {"relay", "connect", "memory"});
  arguments.AddTo(flags);
  flags.Add({"--only", "Scenarios; all if none is named"}, arguments.only);
  flags.Add({"--seconds"}, arguments.seconds, kSecondsRange);
  if (const auto code = flags.Parse(argc, argv)) return *code;
  const bool apart = PinTo(kLoadCore);
  const std::vector<Row> rows = RelayBench(arguments).Run();
  return Publish(
      arguments,
      fmt::format(
          "{}: the server on {}, robots over mutual TLS, {} rounds of {} s; no rate is limited",
          arguments.what, apart ? "a core of its own" : "the only core", arguments.rounds,
          arguments.seconds),
      rows);
}

}  // namespace
}  // namespace uplink::bench

int main(int argc, char** argv) {
  uplink::bench::PrepareLoad();
  return uplink::bench::Run(argc, argv);
}
