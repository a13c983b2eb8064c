// What it costs to pass a change on to thousands of robots, beside brokers that do the same, in one
// run. Servers have one core, the load has the other.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "tests/bench/bench_flags.h"
#include "tests/bench/forward/deliveries.h"
#include "tests/bench/forward/update.h"
#include "tests/bench/load/robots.h"
#include "tests/bench/servers.h"

namespace uplink::bench {
namespace {

using std::chrono::seconds;

struct Arguments : BenchFlags {
  Arguments() : BenchFlags{.rounds = 3, .seconds = 5} {}

  int receivers = 2000;
};

constexpr double kUpdatesPerSecond = 50;
constexpr int kReceiversMax = 20'000;
constexpr double kMicrosPerSecond = 1e6;
constexpr int kWarmUpSeconds = 1;
/// What is still under way at a window's end may take so long.
constexpr seconds kSettleWait{5};
constexpr milliseconds kLook{20};
/// Share of a core above which a server had no more of it.
constexpr double kFullCore = 0.97;
/// Handshakes at a time.
constexpr std::size_t kConnectsAtOnce = 32;
constexpr const char* kTopic = "fleet";
constexpr double kMedian = 0.5;
constexpr double kNearlyAll = 0.99;

/// What the windows of one server showed.
struct Figures {
  Rounds cost_us;
  Rounds delivered;
  Rounds p50_ms;
  Rounds p99_ms;
};

/// One server with its publisher and its receivers.
class Side final {
 public:
  /// The last identity of the world is the publisher's. The references outlive it.
  Side(const World& world, ServerKind kind, link::Loop& loop, const Clock& clock)
      : name_(NameOf(kind)),
        clock_(clock),
        deliveries_(clock),
        origin_ruri_(BenchRuri(world.identities.size() - 1)),
        publishers_{world.identities.back()},
        server_(world, kind),
        receivers_(WhereReceivers(), loop),
        publisher_(WherePublisher(), loop) {}

  void Connect(std::size_t receivers) {
    receiver_count_ = receivers;
    receivers_.ConnectUpTo(receivers, kConnectsAtOnce);
    publisher_.ConnectUpTo(1, 1);
  }

  /// One window of so many seconds.
  void Measure(seconds duration) {
    Publish(seconds(kWarmUpSeconds));
    const synthetic::ProcessUse before = server_.use();
    const SteadyTime began = clock_.Steady();
    const std::size_t due = Publish(duration);
    const double cpu = server_.use().Since(before).cpu_seconds;
    const std::chrono::duration<double> took = clock_.Steady() - began;
    if (cpu > kFullCore * took.count()) {
      fmt::print(stderr, "{}: the server's core was full: an item costs at least this much\n",
                 name_);
    }
    const auto delivered = static_cast<double>(deliveries_.count());
    figures_.cost_us.Add(cpu * kMicrosPerSecond / std::max(delivered, 1.0));
    figures_.delivered.Add(delivered / static_cast<double>(std::max<std::size_t>(due, 1)));
    figures_.p50_ms.Add(deliveries_.WaitOf(kMedian));
    figures_.p99_ms.Add(deliveries_.WaitOf(kNearlyAll));
  }

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const Figures& figures() const { return figures_; }
  /// Updates that left more than 100 ms late.
  [[nodiscard]] std::uint64_t late() const { return publisher_.late(); }

 private:
  /// Robots report; a broker carries what uplinkd makes of a report.
  [[nodiscard]] Load::Where WherePublisher() const {
    Load::Where where = server_.where();
    where.identities = &publishers_;
    where.style = [this, relay = where.protocol == Protocol::kRelay](std::size_t /*number*/) {
      return ClientStyle{.name = "publisher",
                         .topic = kTopic,
                         .write = [this, relay](std::uint64_t seq, std::string& payload) {
                           const Update update{.number = seq, .at = clock_.Steady()};
                           payload = relay ? ReportOf(update) : ForwardOf(update, origin_ruri_);
                         }};
    };
    return where;
  }
  [[nodiscard]] Load::Where WhereReceivers() {
    Load::Where where = server_.where();
    where.style = [this](std::size_t number) {
      return ClientStyle{
          .name = fmt::format("receiver-{}", number),
          .topic = kTopic,
          // Nearly all that a robot hears are updates, and the load has one core.
          .takes = [this](std::string_view message) { return deliveries_.Note(message); },
          .receives = true};
    };
    return where;
  }

  /// Publishes, and waits until all was delivered or what is missing will not come. Returns how
  /// many deliveries were due; those that came are counted.
  std::size_t Publish(seconds duration) {
    deliveries_.Begin();
    const std::uint64_t before = publisher_.sent();
    publisher_.Pace(kUpdatesPerSecond, 1, duration);
    const std::size_t due = (publisher_.sent() - before) * receiver_count_;
    const SteadyTime end = clock_.Steady() + kSettleWait;
    while (deliveries_.count() < due && clock_.Steady() < end) receivers_.RunFor(kLook);
    receivers_.CheckNoneFailed();
    return due;
  }

  const std::string name_;
  const Clock& clock_;
  Deliveries deliveries_;
  /// The publisher is named so in what brokers carry.
  const std::string origin_ruri_;
  const std::vector<link::Identity> publishers_;
  Server server_;
  Load receivers_;
  Load publisher_;
  std::size_t receiver_count_ = 0;
  Figures figures_;
};

class ForwardBench final {
 public:
  explicit ForwardBench(const Arguments& arguments) : arguments_(arguments) {}

  std::vector<Row> Run() {
    const auto receivers = static_cast<std::size_t>(arguments_.receivers);
    world_.MakeRobots(receivers + 1);
    link::Loop loop;
    for (const ServerKind kind : {ServerKind::kUplinkd, ServerKind::kNats,
                                  ServerKind::kMosquittoQos0, ServerKind::kMosquitto}) {
      if (!IsInstalled(kind)) continue;
      fmt::print(stderr, "forward: {} receivers of {}\n", receivers, NameOf(kind));
      sides_.push_back(std::make_unique<Side>(world_, kind, loop, clock_));
      sides_.back()->Connect(receivers);
    }
    for (int round = 0; round < arguments_.rounds; ++round) {
      for (const auto& side : sides_) side->Measure(seconds(arguments_.seconds));
    }
    TellLate();
    std::vector<Row> rows = RowsOf();
    sides_.clear();
    return rows;
  }

 private:
  void TellLate() const {
    for (const auto& side : sides_) {
      if (side->late() == 0) continue;
      fmt::print(stderr, "the load itself was late for {}: {} updates\n", side->name(),
                 side->late());
    }
  }

  /// uplinkd beside every other.
  [[nodiscard]] std::vector<Row> RowsOf() const {
    std::vector<Row> rows;
    AddRows(rows, "forward", "us CPU/item", &Figures::cost_us);
    AddRows(rows, "forward_delivered", "share", &Figures::delivered);
    AddRows(rows, "forward_p50", "ms", &Figures::p50_ms);
    AddRows(rows, "forward_p99", "ms", &Figures::p99_ms);
    return rows;
  }
  void AddRows(std::vector<Row>& rows, const std::string& scenario, const std::string& unit,
               Rounds Figures::*figure) const {
    for (std::size_t i = 1; i < sides_.size(); ++i) {
      rows.push_back({scenario, unit, sides_[i]->name(), sides_.front()->figures().*figure,
                      sides_[i]->figures().*figure});
    }
  }

  const Arguments& arguments_;
  const SystemClock clock_{};
  World world_;
  std::vector<std::unique_ptr<Side>> sides_;
};

int Run(int argc, char** argv) {
  Arguments arguments;
  config::Flags flags("Benchmark of what robots share with each other", "uplink_bench_forward");
  arguments.AddTo(flags);
  flags.Add({"--receivers"}, arguments.receivers, {1, kReceiversMax});
  flags.Add({"--seconds"}, arguments.seconds, kSecondsRange);
  if (const auto code = flags.Parse(argc, argv)) return *code;
  const bool apart = PinTo(kLoadCore);
  const std::vector<Row> rows = ForwardBench(arguments).Run();
  return Publish(arguments,
                 fmt::format("forward: the server on {}, {} receivers over mutual TLS, {} updates "
                             "per second, {} rounds of {} s",
                             apart ? "a core of its own" : "the only core", arguments.receivers,
                             kUpdatesPerSecond, arguments.rounds, arguments.seconds),
                 rows);
}

}  // namespace
}  // namespace uplink::bench

int main(int argc, char** argv) {
  uplink::bench::PrepareLoad();
  return uplink::bench::Run(argc, argv);
}
