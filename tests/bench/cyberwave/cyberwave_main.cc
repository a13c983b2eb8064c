// What it costs to read a fleet's MQTT broker, beside readers that do nothing with it, in one run.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "tests/bench/bare_postgres.h"
#include "tests/bench/bench_flags.h"
#include "tests/bench/cyberwave/messages.h"
#include "tests/bench/cyberwave/side.h"
#include "tests/bench/cyberwave/wire_broker.h"
#include "tests/bench/page.h"
#include "tests/bench/world.h"

namespace uplink::bench {
namespace {

using std::chrono::seconds;

constexpr std::size_t kTwins = 500;
/// Different messages of each twin.
constexpr std::size_t kSteps = 8;
constexpr std::size_t kJointConnections = 20;
constexpr double kJointsPerSecond = 20'000;
constexpr std::size_t kEventConnections = 10;
constexpr Publishers::Ahead kEventsAhead{.window = 64, .backlog = 16'384};
constexpr int kEventsAtOnce = 200;
constexpr int kEventsBefore = 20;
constexpr milliseconds kBetweenEvents{10};
constexpr std::size_t kFrameBytes = 800'000;
constexpr double kFramesPerSecond = 30;
constexpr seconds kWarmUp{2};
/// Of Side::WaitTaken, each a tenth of a second.
constexpr int kLooksLive = 10;
constexpr int kLooksDurable = 300;
constexpr double kMicrosPerSecond = 1e6;
constexpr double kBytesPerMib = 1024 * 1024;
constexpr double kPercent = 100;
constexpr double kMedian = 0.5;
constexpr double kNearlyAll = 0.99;

/// How a scenario is measured. A value.
struct CyberwaveRun {
  const Clock& clock;
  /// A migrated PostgreSQL database that no other server uses.
  std::string postgres_url;
  int rounds = 3;
  int seconds = 5;
};

using SidePtr = std::unique_ptr<Side>;
using Moment = Side::Moment;

double SecondsBetween(const Moment& before, const Moment& after) {
  return std::chrono::duration<double>(after.at - before.at).count();
}

double CostUs(const Moment& before, const Moment& after) {
  const auto taken = static_cast<double>(after.taken - before.taken);
  return (after.cpu_seconds - before.cpu_seconds) * kMicrosPerSecond / std::max(taken, 1.0);
}

template <typename Reader>
std::unique_ptr<Subscriber> ReadPlainly(std::uint16_t broker_port) {
  return std::make_unique<Reader>(broker_port);
}

/// Makes an uplinkd on that store.
auto MakeUplinkd(const std::string& store_url, const std::string& media) {
  return [store_url, media](std::uint16_t broker_port) -> std::unique_ptr<Subscriber> {
    auto made = std::make_unique<Uplinkd>(
        Uplinkd::Options{.broker_port = broker_port, .store_url = store_url, .media = media});
    made->WaitConnected();
    return made;
  };
}

/// Says what became of messages that should all have become `wanted`.
void TellOthers(Side& side, const std::string& wanted) {
  const auto* uplinkd = dynamic_cast<const Uplinkd*>(&side.subscriber());
  if (uplinkd == nullptr) return;
  for (const auto& [name, count] : uplinkd->Metrics()) {
    const bool settled = name.starts_with("uplinkd_mqtt_messages_settled_total{");
    if (!settled || count == 0 || name.find('"' + wanted + '"') != std::string::npos) continue;
    fmt::print(stderr, "not all became {}: {} {:.0f}\n", wanted, name, count);
  }
}

void TellLate(Side& side) {
  if (side.publishers().late() == 0) return;
  fmt::print(stderr, "the load itself was late for {}: {} messages\n", side.subscriber().name(),
             side.publishers().late());
}

/// What the windows of one reader showed.
struct Figures {
  Rounds cost_us;
  Rounds delivered;
  Rounds per_second;
};

/// The first reader beside each of the others.
void AddRows(std::vector<Row>& rows, const std::string& scenario, const std::string& unit,
             std::vector<SidePtr>& sides, const std::vector<Figures>& figures,
             Rounds Figures::*figure) {
  for (std::size_t i = 1; i < sides.size(); ++i) {
    rows.push_back(
        {scenario, unit, sides[i]->subscriber().name(), figures[0].*figure, figures[i].*figure});
  }
}

void MeasureJointsOf(const CyberwaveRun& run, Side& side, Figures& figures) {
  const Moment begin = side.Now(run.clock);
  side.publishers().Pace(kJointsPerSecond, kWarmUp);
  side.WaitTaken(begin, kLooksLive);
  const Moment before = side.Now(run.clock);
  side.publishers().Pace(kJointsPerSecond, seconds(run.seconds));
  side.WaitTaken(before, kLooksLive);
  const Moment after = side.Now(run.clock);
  figures.cost_us.Add(CostUs(before, after));
  figures.delivered.Add(static_cast<double>(after.taken - before.taken) /
                        static_cast<double>(after.sent - before.sent));
}

void MeasureEventsOf(const CyberwaveRun& run, Side& side, Figures& figures) {
  const auto settled = [&side] { return side.subscriber().count(); };
  const Moment begin = side.Now(run.clock);
  side.publishers().Flood(kEventsAhead, settled, kWarmUp);
  const Moment before = side.Now(run.clock);
  const std::uint64_t ahead = before.sent - begin.sent - (before.taken - begin.taken);
  side.publishers().Flood(
      {kEventsAhead.window,
       kEventsAhead.backlog - std::min<std::uint64_t>(ahead, kEventsAhead.backlog)},
      settled, seconds(run.seconds));
  const Moment after = side.Now(run.clock);
  side.WaitTaken(begin, kLooksDurable);
  figures.cost_us.Add(CostUs(before, after));
  figures.per_second.Add(static_cast<double>(after.taken - before.taken) /
                         SecondsBetween(before, after));
  const Moment end = side.Now(run.clock);
  figures.delivered.Add(static_cast<double>(end.taken - begin.taken) /
                        static_cast<double>(end.sent - begin.sent));
}

// Each returns its rows. Broker and publishers have one core, who reads the broker has the other,
// PostgreSQL either. Every reader has a broker and publishers of its own, which rest while another
// one is measured.

/// Flat joints of six at QoS 0, 20,000 per second of 500 twins: the reader's CPU for each, beside
/// a bare sink and an exporter.
std::vector<Row> MeasureJoints(const CyberwaveRun& run) {
  const auto load = [] { return Side::Load{kJointConnections, JointPackets(kTwins, kSteps)}; };
  std::vector<SidePtr> sides;
  sides.push_back(std::make_unique<Side>(MakeUplinkd("", "off"), load(), run.clock));
  sides.push_back(std::make_unique<Side>(ReadPlainly<Sink>, load(), run.clock));
  if (Exporter::IsInstalled()) {
    sides.push_back(std::make_unique<Side>(ReadPlainly<Exporter>, load(), run.clock));
  } else {
    fmt::print(stderr, "install prometheus-mqtt-exporter (tools/dev/packages.txt) to compare\n");
  }
  std::vector<Figures> figures(sides.size());
  for (int round = 0; round < run.rounds; ++round) {
    for (std::size_t i = 0; i < sides.size(); ++i) MeasureJointsOf(run, *sides[i], figures[i]);
  }
  for (const SidePtr& side : sides) TellLate(*side);
  TellOthers(*sides.front(), "applied");
  std::vector<Row> rows;
  AddRows(rows, "joints", "us CPU/message", sides, figures, &Figures::cost_us);
  AddRows(rows, "joints_delivered", "share", sides, figures, &Figures::delivered);
  return rows;
}

/// Events at QoS 1 with a backlog in the broker: how many per second are committed and acked,
/// beside a sink that acks at once.
std::vector<Row> MeasureEvents(const CyberwaveRun& run) {
  const auto load = [] { return Side::Load{kEventConnections, EventPackets(kTwins, kSteps)}; };
  std::vector<SidePtr> sides;
  sides.push_back(std::make_unique<Side>(MakeUplinkd(run.postgres_url, "off"), load(), run.clock));
  sides.push_back(std::make_unique<Side>(ReadPlainly<Sink>, load(), run.clock));
  std::vector<Figures> figures(sides.size());
  for (int round = 0; round < run.rounds; ++round) {
    for (std::size_t i = 0; i < sides.size(); ++i) MeasureEventsOf(run, *sides[i], figures[i]);
  }
  TellOthers(*sides.front(), "stored");
  std::vector<Row> rows;
  AddRows(rows, "events", "1/s", sides, figures, &Figures::per_second);
  AddRows(rows, "events_cost", "us CPU/message", sides, figures, &Figures::cost_us);
  AddRows(rows, "events_acked", "share", sides, figures, &Figures::delivered);
  return rows;
}

/// One event at a time on an idle server: from PUBLISH to PUBACK on the wire, beside a bare commit.
std::vector<Row> MeasureAcks(const CyberwaveRun& run) {
  WireBroker broker(run.clock);
  Uplinkd uplinkd({.broker_port = broker.port(), .store_url = run.postgres_url});
  broker.WaitFor("/twin/+/event");
  LoadShape single;
  single.batch_records = 1;
  single.per_robot = 1;
  BarePostgres bare(run.postgres_url, single, 0);
  const std::string topic = "cyberwave/twin/" + TwinId(0) + "/event";
  for (int i = 0; i < kEventsBefore; ++i) static_cast<void>(broker.Publish(topic, EventText(0)));
  Row p50{"ack_p50", "ms", "bare libpq commit", {}, {}};
  Row p99{"ack_p99", "ms", "bare libpq commit", {}, {}};
  Row own_p50{"ack_p50_by_its_metric", "ms", "on the wire", {}, {}};
  Row own_p99{"ack_p99_by_its_metric", "ms", "on the wire", {}, {}};
  for (int round = 0; round < run.rounds; ++round) {
    std::vector<double> ours;
    std::vector<double> theirs;
    const Samples before = uplinkd.Metrics();
    for (int i = 0; i < kEventsAtOnce; ++i) {
      broker.Rest(kBetweenEvents);
      ours.push_back(broker.Publish(topic, EventText(static_cast<std::size_t>(i))));
    }
    const Samples after = uplinkd.Metrics();
    for (int i = 0; i < kEventsAtOnce; ++i) {
      broker.Rest(kBetweenEvents);
      const SteadyTime began = run.clock.Steady();
      bare.CommitOne();
      theirs.push_back(
          std::chrono::duration<double, std::milli>(run.clock.Steady() - began).count());
    }
    for (auto [row, own, share] :
         {std::tuple{&p50, &own_p50, kMedian}, std::tuple{&p99, &own_p99, kNearlyAll}}) {
      row->value.Add(Quantile(ours, share));
      row->comparator_value.Add(Quantile(theirs, share));
      own->value.Add(HistogramMs(before, after, "uplinkd_mqtt_ack_seconds", share));
      own->comparator_value.Add(Quantile(ours, share));
    }
  }
  return {p50, p99, own_p50, own_p99};
}

/// Depth frames of 800 KB, 30 per second: what they add to an idle server that counts media, and to
/// one that does not.
std::vector<Row> MeasureDepth(const CyberwaveRun& run) {
  std::vector<Row> rows;
  for (const std::string media : {"count", "off"}) {
    Side side(MakeUplinkd("", media), {1, DepthPackets(kFrameBytes)}, run.clock);
    side.publishers().Pace(0, kWarmUp);
    Row cpu{"depth_" + media + "_cpu", "% of a core, added", "", {}, {}};
    Row memory{"depth_" + media + "_memory", "MiB, added", "", {}, {}};
    Row taken{"depth_" + media + "_frames", "1/s", "", {}, {}};
    const std::uint64_t rss_before = side.Now(run.clock).rss_bytes;
    for (int round = 0; round < run.rounds; ++round) {
      const Moment idle = side.Now(run.clock);
      side.publishers().Pace(0, seconds(run.seconds));
      const Moment begin = side.Now(run.clock);
      side.publishers().Pace(kFramesPerSecond, seconds(run.seconds));
      const Moment end = side.Now(run.clock);
      const double without = (begin.cpu_seconds - idle.cpu_seconds) / SecondsBetween(idle, begin);
      const double with = (end.cpu_seconds - begin.cpu_seconds) / SecondsBetween(begin, end);
      cpu.value.Add((with - without) * kPercent);
      memory.value.Add((static_cast<double>(end.rss_bytes) - static_cast<double>(rss_before)) /
                       kBytesPerMib);
      taken.value.Add(static_cast<double>(end.taken - begin.taken) / SecondsBetween(begin, end));
    }
    TellLate(side);
    for (Row* row : {&cpu, &memory, &taken}) rows.push_back(std::move(*row));
  }
  return rows;
}

struct Arguments : BenchFlags {
  Arguments() : BenchFlags{.rounds = 3, .seconds = 5} {}

  std::string url;
  std::string only;
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
  constexpr auto kRequired = config::Flag::Need::kRequired;
  config::Flags flags("Benchmark of reading a fleet's MQTT broker", "uplink_bench_cyberwave");
  flags.Add({"--url", "A migrated PostgreSQL database", kRequired}, arguments.url);
  arguments.AddTo(flags);
  flags.AddChoice({"--only", "One scenario"}, arguments.only, {"joints", "events", "ack", "depth"});
  flags.Add({"--seconds"}, arguments.seconds, kSecondsRange);
  if (const auto code = flags.Parse(argc, argv)) return *code;
  const bool apart = PinTo(kLoadCore);
  const std::vector<Row> rows = RowsOf(arguments);
  return Publish(arguments,
                 fmt::format("cyberwave: who reads on {}, broker and publishers on {}, PostgreSQL "
                             "on any; {} rounds of {} s",
                             apart ? "a core of its own" : "the only core",
                             apart ? "another" : "it", arguments.rounds, arguments.seconds),
                 rows);
}

}  // namespace
}  // namespace uplink::bench

int main(int argc, char** argv) {
  uplink::bench::PrepareLoad();
  return uplink::bench::Run(argc, argv);
}
