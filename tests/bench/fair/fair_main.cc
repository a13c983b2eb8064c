// What one robot costs the others: well-behaved robots beside one that misbehaves in every way that
// it may, before and while it does. The server has one core, all robots the other.
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "tests/bench/fair/fair_report.h"
#include "tests/bench/fair/misbehaviour.h"
#include "tests/bench/fair/watch.h"
#include "tests/bench/trouble.h"
#include "tests/bench/trouble_flags.h"
#include "tests/support/postgres_database.h"
#include "tools/uplink-fleet/run/signals.h"

namespace uplink::bench {
namespace {

constexpr std::chrono::seconds kConnectWait{60};
constexpr std::chrono::seconds kWarmUp{3};
/// The bad robot may have something to prepare.
constexpr std::chrono::seconds kBeginWait{20};
constexpr std::chrono::seconds kBadEndWait{5};
constexpr double kPercent = 100;
/// A live message per second and an event every two.
constexpr Others::Rhythm kRhythm{.messages_per_second = 1.5, .live = 2};
constexpr double kMedian = 0.5;
constexpr double kP99 = 0.99;

/// A store of its own for one scenario.
class FreshStore final {
 public:
  FreshStore(const World& world, const std::string& kind) {
    if (kind == "postgres") {
      database_.emplace(testing::DatabaseContent::kEmpty);
    } else {
      file_.emplace(world.folder.Path("fair.db"));
    }
  }
  /// The schema's owner: the server that is measured makes the schema that it knows.
  [[nodiscard]] std::string url() const {
    return database_ ? database_->owner_url() : file_->url();
  }

 private:
  std::optional<testing::PostgresDatabase> database_;
  std::optional<FreshFile> file_;
};

class Scenario final {
 public:
  Scenario(const TroubleRun& run, const Misdeed& misdeed, PinnedServer& server)
      : run_(run),
        misdeed_(misdeed),
        server_(server),
        scene_(run, server, kRhythm),
        watch_(server.ports().http, BadRuri(), misdeed) {}

  FairResult Run() {
    FairResult result{.misdeed = std::string(misdeed_.name)};
    const std::size_t robots = run_.robots;
    const std::size_t open = scene_.others().Connect(run_.world.identities, robots, kConnectWait);
    if (open < robots) {
      result.failure = fmt::format("{} of {} robots were welcomed", open, robots);
      return result;
    }
    scene_.others().Drive(scene_.For(kWarmUp));
    result.without = Measure(Watch::Window::kWithout);
    if (server_.ended() || run_.stopped()) {
      result.failure = "the server ended, or the run was stopped, before the bad robot began";
      return result;
    }
    const auto bad = StartBadRobot();
    AwaitBadRobot(*bad);
    result.with = Measure(Watch::Window::kWith);
    bad->Signal(SIGTERM);
    static_cast<void>(bad->WaitForExit(kBadEndWait));
    const std::size_t did = bad->text().find("did: ");
    run_.say("  the bad robot: " +
             (did == std::string::npos ? bad->text() : bad->text().substr(did)));
    TellWhatWasSeen();
    result.server_ended = server_.ended();
    if (run_.stopped()) result.failure = "stopped";
    return result;
  }

 private:
  static std::string BadRuri() { return "rcan://bench.local/robots/bad"; }

  [[nodiscard]] testing::CertificateSpec BadSpec() const {
    testing::CertificateSpec spec = testing::RobotSpec(BadRuri());
    if (!misdeed_.by_gateway) return spec;
    spec.units = {"gateway"};
    spec.uris = RobotsOfGateway(BadRuri());
    return spec;
  }

  WindowFigures Measure(Watch::Window window) {
    watch_.Enter(window);
    scene_.ForgetMemory();
    const SteadyTime began = scene_.clock().Steady();
    const synthetic::ProcessUse before = server_.use();
    const OthersTally tally = scene_.others().Measure(scene_.For(run_.window));
    const double cpu = server_.use().Since(before).cpu_seconds;
    const double took = std::chrono::duration<double>(scene_.clock().Steady() - began).count();
    watch_.Enter(Watch::Window::kNone);
    const WatchFigures seen = watch_.Of(window);
    return {.ack_p50_ms = Quantile(tally.ack_ms, kMedian),
            .ack_p99_ms = Quantile(tally.ack_ms, kP99),
            .acks = tally.ack_ms.size() - tally.unacked,
            .unacked = tally.unacked,
            .cut = tally.cut,
            .rejects = tally.rejects,
            .late = tally.late,
            .unknown = seen.unknown.size(),
            .offline = seen.offline.size(),
            .cpu_percent = kPercent * cpu / took,
            .memory_mib = scene_.memory_max_mib(),
            .scrapes = seen.scrapes,
            .scrapes_failed = seen.failed,
            .law_broken = seen.law_broken};
  }

  std::unique_ptr<testing::ServerProcess> StartBadRobot() const {
    const testing::UplinkdFolder& folder = run_.world.folder;
    const testing::KeyPair pair = folder.authority().Issue(BadSpec());
    folder.Write("bad.crt", pair.certificate);
    folder.Write("bad.key", pair.key);
    // It also ends by itself, in case this process is gone by then.
    const auto most = std::chrono::ceil<std::chrono::seconds>(run_.window) + kBeginWait +
                      std::chrono::duration_cast<std::chrono::seconds>(Others::kAckPatience) +
                      kBadEndWait;
    return std::make_unique<testing::ServerProcess>(std::vector<std::string>{
        BAD_ROBOT_PROGRAM, "--misdeed", std::string(misdeed_.name), "--ruri", BadRuri(), "--folder",
        folder.Path(""), "--port", std::to_string(server_.ports().relay), "--seconds",
        std::to_string(most.count())});
  }

  void AwaitBadRobot(testing::ServerProcess& bad) {
    bool at_work = false;
    const Others::OnTurn turn = scene_.For(kBeginWait);
    scene_.others().Drive([&] {
      at_work = at_work || bad.WaitFor("at work", milliseconds(2));
      return !at_work && turn();
    });
    if (!at_work) run_.say("  the bad robot did not begin in time, and is measured as it is");
  }

  void TellWhatWasSeen() const {
    const WatchFigures seen = watch_.Of(Watch::Window::kWith);
    run_.say(
        fmt::format("  meanwhile: at most {:.0f} streams held back, {:.1f} MiB in the journal,"
                    " the slowest of {} scrapes {:.0f} ms",
                    seen.held_back, seen.journal_bytes / kMiB, seen.scrapes, seen.slowest_ms));
    if (!seen.law_example.empty()) run_.say("  the law was broken: " + seen.law_example);
    if (!seen.last_failure.empty()) run_.say("  a request failed: " + seen.last_failure);
  }

  const TroubleRun& run_;
  const Misdeed& misdeed_;
  PinnedServer& server_;
  Scene scene_;
  Watch watch_;
};

FairResult Measured(const TroubleRun& run, const std::string& store_kind, const Misdeed& misdeed) {
  run.say(fmt::format("{}: {}", misdeed.name, misdeed.about));
  const FreshStore store(run.world, store_kind);
  auto server = StartServer(run, store.url());
  if (!server.ok()) {
    return {.misdeed = std::string(misdeed.name),
            .failure = std::string(server.status().message())};
  }
  FairResult result = Scenario(run, misdeed, **server).Run();
  run.say("  the server: " + (*server)->Stop());
  return result;
}

int Run(int argc, char** argv) {
  FairFlags flags;
  if (const auto code = ParseFairFlags(argc, argv, NamesOf(Misdeeds()), flags)) return *code;
  const SystemClock clock;
  synthetic::Signals signals(clock);
  bool stopped = false;
  const bool apart = PinTo(kLoadCore);
  World world;
  world.MakeRobots(static_cast<std::size_t>(flags.robots));
  const TroubleRun run{.world = world,
                       .server_bin = flags.server_bin.empty() ? UPLINKD_PROGRAM : flags.server_bin,
                       .window = std::chrono::seconds(flags.seconds),
                       .robots = static_cast<std::size_t>(flags.robots),
                       .stopped = [&] { return stopped = stopped || signals.Came(); },
                       .say = Say};
  std::vector<FairResult> results;
  for (int round = 0; round < flags.rounds; ++round) {
    for (const Misdeed* misdeed : ChosenOf(Misdeeds(), flags.only)) {
      if (run.stopped()) break;
      results.push_back(Measured(run, flags.store, *misdeed));
      fmt::print(stderr, "{}", FairTable({results.back()}, flags.share_mib));
    }
  }
  fmt::print(
      "fair: {} robots with a live message per second and an event every two, on {}; the server on"
      " {}; {} rounds, two windows of {} s each, without the bad robot and with it\n{}",
      flags.robots, flags.store, apart ? "a core of its own" : "the only core", flags.rounds,
      flags.seconds, FairTable(results, flags.share_mib));
  const bool kept = KeepJson(flags.json, FairRows(results, flags.share_mib), flags.commit);
  const bool measured =
      std::ranges::any_of(results, [](const FairResult& result) { return result.failure.empty(); });
  return measured && kept && !stopped ? 0 : 1;
}

}  // namespace
}  // namespace uplink::bench

int main(int argc, char** argv) {
  uplink::bench::PrepareLoad();
  return uplink::bench::Run(argc, argv);
}
