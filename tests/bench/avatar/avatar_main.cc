// What a drone's call costs uplinkd, beside a bare server of the gRPC library, and beside a message
// of a robot's stream, in one run. Servers have one core, the load has the other.
#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "tests/bench/avatar/drone_client.h"
#include "tests/bench/bench_flags.h"
#include "tests/bench/load/robots.h"
#include "tests/bench/servers.h"
#include "tests/bench/trouble_flags.h"

namespace uplink::bench {
namespace {

using std::chrono::seconds;

struct Arguments : BenchFlags {
  Arguments() : BenchFlags{.rounds = 3, .seconds = 5} {}

  std::vector<std::string> only;
  int drones = 400;
};

/// A sample of each type of telemetry, once a second.
constexpr double kCallsPerSecond = 23;
constexpr int kDronesMin = 20;
constexpr int kDronesMax = 10'000;
/// As many streams as a gateway's connection may have.
constexpr std::size_t kGatewayDrones = 256;
/// Of the relay's scenario `paced_1`.
constexpr std::size_t kPacedRobots = 2000;
constexpr double kPacedHz = 10;
/// Drones that a server has served before its memory is measured, and what each does meanwhile.
constexpr std::size_t kFirstDrones = 16;
constexpr std::size_t kMemoryRounds = 3;
constexpr seconds kWarmUp{1};
/// What is still under way at a window's end may take so long.
constexpr seconds kSettleWait{10};
constexpr milliseconds kLook{20};
/// Share of a core above which a server had no more of it.
constexpr double kFullCore = 0.97;
/// Handshakes at a time.
constexpr std::size_t kConnectsAtOnce = 32;
constexpr double kMicrosPerSecond = 1e6;
constexpr double kBytesAKiB = 1024;
constexpr double kMedian = 0.5;
constexpr double kNearlyAll = 0.99;
constexpr std::array kKinds = {ServerKind::kUplinkd, ServerKind::kGrpcSink};

void Say(const std::string& text) { fmt::print(stderr, "{}\n", text); }

/// Microseconds of the server's CPU for each message of a window, evenly spread over the clients.
double CostOf(const std::string& name, const Server& server, Load& load, double per_second,
              seconds duration) {
  const synthetic::ProcessUse before = server.use();
  const std::uint64_t acked = load.acked();
  const std::uint64_t sent = load.sent();
  load.Pace(per_second, 1, duration);
  const double cpu = server.use().Since(before).cpu_seconds;
  if (cpu > kFullCore * static_cast<double>(duration.count())) {
    Say(name + ": the server's core was full: a message costs at least this much");
  }
  // What is under way at the end is about as much as at the beginning.
  const double messages = static_cast<double>(std::max(load.acked() - acked, load.sent() - sent));
  return cpu * kMicrosPerSecond / std::max(messages, 1.0);
}

void TellLate(const std::string& name, const Load& load) {
  if (load.late() > 0) Say(fmt::format("the load itself was late for {}: {}", name, load.late()));
}

/// What the windows of one server showed.
struct Figures {
  Rounds cost_us;
  Rounds live_p50_ms;
  Rounds live_p99_ms;
  Rounds durable_p50_ms;
  Rounds durable_p99_ms;
  Rounds per_second;
  /// Over all rounds.
  std::uint64_t failed = 0;
};

/// One server with drones, each by a connection of its own or all through one gateway's.
class Side final {
 public:
  struct Setup {
    ServerKind kind = ServerKind::kUplinkd;
    std::vector<AvatarSample> samples;
    /// Whom each drone goes through.
    std::optional<link::Identity> gateway = {};
  };
  /// The references outlive it.
  Side(const World& world, link::Loop& loop, const Clock& clock, Setup setup)
      : name_(NameOf(setup.kind)),
        world_(world),
        loop_(loop),
        clock_(clock),
        drones_{.clock = clock, .samples = std::move(setup.samples), .tally = {}},
        gateway_(std::move(setup.gateway)),
        server_(world, setup.kind, 1, {"UPLINKD_UNCREW_AVATAR=true"}),
        load_(WhereDrones(), loop) {}

  void ConnectUpTo(std::size_t drones) {
    load_.ConnectUpTo(drones, kConnectsAtOnce);
    count_ = drones;
  }
  /// Each drone publishes all its samples so often, one at a time.
  void Publish(std::size_t times) {
    for (std::size_t i = 0; i < times * drones_.samples.size(); ++i) load_.SendOneAndAwaitAck();
    TakeTally();
  }

  /// One window.
  void Measure(seconds duration) {
    const double per_second = static_cast<double>(count_) * kCallsPerSecond;
    load_.Pace(per_second, 1, kWarmUp);
    Settle();
    TakeTally();
    const std::uint64_t before = load_.acked();
    const SteadyTime began = clock_.Steady();
    figures_.cost_us.Add(CostOf(name_, server_, load_, per_second, duration));
    const std::chrono::duration<double> took = clock_.Steady() - began;
    figures_.per_second.Add(static_cast<double>(load_.acked() - before) / took.count());
    Settle();
    const CallTally tally = TakeTally();
    figures_.live_p50_ms.Add(Quantile(tally.live_ms, kMedian));
    figures_.live_p99_ms.Add(Quantile(tally.live_ms, kNearlyAll));
    figures_.durable_p50_ms.Add(Quantile(tally.durable_ms, kMedian));
    figures_.durable_p99_ms.Add(Quantile(tally.durable_ms, kNearlyAll));
  }

  [[nodiscard]] std::uint64_t rss_bytes() const { return server_.use().rss_bytes; }
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const Figures& figures() const { return figures_; }
  [[nodiscard]] const Load& load() const { return load_; }

 private:
  [[nodiscard]] Load::Where WhereDrones() {
    Load::Where where;
    where.connect = [this](std::size_t number) -> std::unique_ptr<Client> {
      link::LinkOptions options = server_.where().link;
      // Headers and request of a call leave together, as a client of gRPC's library writes them.
      options.record_per_message = false;
      const std::string authority = options.address.text;
      if (!gateway_) {
        options.identity = world_.identities.at(number);
        return std::make_unique<DroneClient>(drones_, NewLink(options, link::Http2Link::For::kOne),
                                             authority, DroneClient::Who{.number = number});
      }
      options.identity = *gateway_;
      std::shared_ptr<link::Http2Link> link = gateway_link_.lock();
      if (link == nullptr) {
        gateway_link_ = link = NewLink(options, link::Http2Link::For::kSeveral);
      }
      return std::make_unique<DroneClient>(
          drones_, std::move(link), authority,
          DroneClient::Who{.number = number, .uav_id = BenchRuri(number)});
    };
    return where;
  }
  [[nodiscard]] std::shared_ptr<link::Http2Link> NewLink(const link::LinkOptions& options,
                                                         link::Http2Link::For users) {
    return std::make_shared<link::Http2Link>(loop_, options, users);
  }

  /// Waits until every call was answered; one that is not counts as failed.
  void Settle() {
    const SteadyTime end = clock_.Steady() + kSettleWait;
    while (load_.acked() < load_.sent() && clock_.Steady() < end) load_.RunFor(kLook);
    load_.CheckNoneFailed();
    const std::uint64_t open = load_.sent() - load_.acked();
    if (open > 0) Say(fmt::format("{}: {} calls were not answered", name_, open));
    figures_.failed += open;
  }

  /// What came since it was last taken.
  CallTally TakeTally() {
    CallTally tally = std::exchange(drones_.tally, {});
    figures_.failed += tally.failed;
    if (tally.failed + tally.not_taken > 0) {
      Say(fmt::format("{}: {} calls failed, {} samples were neither applied nor stored; {}", name_,
                      tally.failed, tally.not_taken, tally.example));
    }
    return tally;
  }

  const std::string name_;
  const World& world_;
  link::Loop& loop_;
  const Clock& clock_;
  DroneWorld drones_;
  const std::optional<link::Identity> gateway_;
  /// The drones own it.
  std::weak_ptr<link::Http2Link> gateway_link_;
  Server server_;
  Load load_;
  std::size_t count_ = 0;
  Figures figures_;
};
using Sides = std::array<std::unique_ptr<Side>, kKinds.size()>;

class AvatarBench final {
 public:
  explicit AvatarBench(const Arguments& arguments)
      : arguments_(arguments), drones_(static_cast<std::size_t>(arguments.drones)) {}

  void Live() { MeasureDrones("live", LiveSamples(), drones_, std::nullopt); }
  void All() { MeasureDrones("all", AllSamples(), drones_, std::nullopt); }
  void Gateway() {
    const std::size_t drones = std::min(drones_, kGatewayDrones);
    MeasureDrones("gateway", AllSamples(), drones, world_.MakeGateways(1, drones).front());
  }

  /// As the relay's benchmark has it: a message of a robot's stream.
  void Paced() {
    world_.MakeRobots(kPacedRobots);
    Row row{"paced_1", "us CPU/message", NameOf(ServerKind::kGrpcSink), {}, {}};
    link::Loop loop;
    std::vector<std::unique_ptr<Server>> servers;
    std::vector<std::unique_ptr<Load>> loads;
    for (const ServerKind kind : kKinds) {
      Say(fmt::format("paced_1: {} robots of {}", kPacedRobots, NameOf(kind)));
      servers.push_back(std::make_unique<Server>(world_, kind));
      loads.push_back(std::make_unique<Load>(servers.back()->where(), loop));
      loads.back()->ConnectUpTo(kPacedRobots, kConnectsAtOnce);
    }
    const double per_second = static_cast<double>(kPacedRobots) * kPacedHz;
    for (int round = 0; round < arguments_.rounds; ++round) {
      for (std::size_t i = 0; i < kKinds.size(); ++i) {
        loads[i]->Pace(per_second, 1, kWarmUp);
        const double cost = CostOf(NameOf(kKinds.at(i)), *servers[i], *loads[i], per_second,
                                   seconds(arguments_.seconds));
        (i == 0 ? row.value : row.comparator_value).Add(cost);
      }
    }
    for (std::size_t i = 0; i < kKinds.size(); ++i) TellLate(NameOf(kKinds.at(i)), *loads[i]);
    rows_.push_back(std::move(row));
  }

  /// Resident memory that a drone adds, with its connection and a sample of each type.
  void Memory() {
    world_.MakeRobots(drones_);
    Row row{"memory", "KiB/drone", NameOf(ServerKind::kGrpcSink), {}, {}};
    for (int round = 0; round < arguments_.rounds; ++round) {
      for (const ServerKind kind : kKinds) {
        Say("memory: " + NameOf(kind));
        link::Loop loop;
        Side side(world_, loop, clock_, {.kind = kind, .samples = AllSamples()});
        side.ConnectUpTo(kFirstDrones);
        side.Publish(kMemoryRounds);
        const std::uint64_t before = side.rss_bytes();
        side.ConnectUpTo(drones_);
        side.Publish(kMemoryRounds);
        const double added = static_cast<double>(side.rss_bytes()) - static_cast<double>(before);
        (kind == ServerKind::kUplinkd ? row.value : row.comparator_value)
            .Add(added / kBytesAKiB / static_cast<double>(drones_ - kFirstDrones));
      }
    }
    rows_.push_back(std::move(row));
  }

  [[nodiscard]] std::vector<Row> TakeRows() { return std::move(rows_); }

 private:
  void MeasureDrones(const std::string& name, const std::vector<AvatarSample>& samples,
                     std::size_t drones, const std::optional<link::Identity>& gateway) {
    if (!gateway) world_.MakeRobots(drones);
    link::Loop loop;
    Sides sides;
    for (std::size_t i = 0; i < kKinds.size(); ++i) {
      Say(fmt::format("{}: {} drones of {}", name, drones, NameOf(kKinds.at(i))));
      sides.at(i) = std::make_unique<Side>(
          world_, loop, clock_,
          Side::Setup{.kind = kKinds.at(i), .samples = samples, .gateway = gateway});
      sides.at(i)->ConnectUpTo(drones);
      // What is a drone's first costs more, and the first of a mode is stored.
      sides.at(i)->Publish(1);
    }
    for (int round = 0; round < arguments_.rounds; ++round) {
      for (const auto& side : sides) side->Measure(seconds(arguments_.seconds));
    }
    for (const auto& side : sides) TellLate(side->name(), side->load());
    AddRow(name, "us CPU/call", sides, &Figures::cost_us);
    AddRow(name + "_p50", "ms", sides, &Figures::live_p50_ms);
    AddRow(name + "_p99", "ms", sides, &Figures::live_p99_ms);
    if (samples.size() > LiveSamples().size()) {
      AddRow(name + "_durable_p50", "ms", sides, &Figures::durable_p50_ms);
      AddRow(name + "_durable_p99", "ms", sides, &Figures::durable_p99_ms);
    }
    AddRow(name + "_answered", "1/s", sides, &Figures::per_second);
    Row failed{name + "_not_ok", "calls", sides.back()->name(), {}, {}};
    failed.value.Add(static_cast<double>(sides.front()->figures().failed));
    failed.comparator_value.Add(static_cast<double>(sides.back()->figures().failed));
    rows_.push_back(std::move(failed));
  }

  /// uplinkd beside the sink.
  void AddRow(const std::string& scenario, const std::string& unit, const Sides& sides,
              Rounds Figures::*figure) {
    rows_.push_back({scenario, unit, sides.back()->name(), sides.front()->figures().*figure,
                     sides.back()->figures().*figure});
  }

  const Arguments& arguments_;
  const std::size_t drones_;
  const SystemClock clock_{};
  World world_;
  std::vector<Row> rows_;
};

struct Scenario {
  std::string_view name;
  void (AvatarBench::*measure)();
};
constexpr std::array<Scenario, 5> kScenarios = {{{"live", &AvatarBench::Live},
                                                 {"paced_1", &AvatarBench::Paced},
                                                 {"all", &AvatarBench::All},
                                                 {"gateway", &AvatarBench::Gateway},
                                                 {"memory", &AvatarBench::Memory}}};

int Run(int argc, char** argv) {
  Arguments arguments;
  const std::span<const Scenario> scenarios(kScenarios);
  config::Flags flags("Benchmark of drones' calls", "uplink_bench_avatar");
  arguments.AddTo(flags);
  flags.AddChoices({"--only", "Scenarios; all if none is named"}, arguments.only,
                   NamesOf(scenarios));
  flags.Add({"--drones"}, arguments.drones, {kDronesMin, kDronesMax});
  flags.Add({"--seconds"}, arguments.seconds, kSecondsRange);
  if (const auto code = flags.Parse(argc, argv)) return *code;
  const bool apart = PinTo(kLoadCore);
  AvatarBench bench(arguments);
  for (const Scenario* scenario : ChosenOf(scenarios, arguments.only)) {
    (bench.*scenario->measure)();
  }
  return Publish(arguments,
                 fmt::format("avatar: the server on {}, {} drones over mutual TLS, {} calls per "
                             "second each, {} rounds of {} s",
                             apart ? "a core of its own" : "the only core", arguments.drones,
                             kCallsPerSecond, arguments.rounds, arguments.seconds),
                 bench.TakeRows());
}

}  // namespace
}  // namespace uplink::bench

int main(int argc, char** argv) {
  uplink::bench::PrepareLoad();
  return uplink::bench::Run(argc, argv);
}
