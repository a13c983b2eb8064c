#include "tests/bench/fair/fair_run.h"

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/core.h>

#include "tests/bench/fair/gateway_flood.h"
#include "tests/bench/fair/others.h"
#include "tests/bench/fair/watch.h"
#include "tests/bench/pinned_server.h"
#include "tests/support/postgres_database.h"

namespace uplink::bench {
namespace {

constexpr std::chrono::seconds kConnectWait{60};
constexpr std::chrono::seconds kWarmUp{3};
/// The bad robot may have something to prepare.
constexpr std::chrono::seconds kBeginWait{20};
constexpr std::chrono::seconds kBadEndWait{5};
constexpr milliseconds kReadLogEvery{1'000};
constexpr double kMiB = 1024.0 * 1024.0;
constexpr double kPercent = 100;
constexpr double kMedian = 0.5;
constexpr double kP99 = 0.99;

/// A store of its own for one scenario.
class FreshStore final {
 public:
  FreshStore(const World& world, const FairFlags& flags) {
    if (flags.store == "postgres") {
      database_.emplace(testing::DatabaseContent::kEmpty);
      // The schema's owner: the server that is measured makes the schema that it knows.
      url_ = database_->owner_url();
      return;
    }
    file_ = world.folder.Path("fair.db");
    Remove();
    url_ = "sqlite://" + file_;
  }
  ~FreshStore() { Remove(); }
  FreshStore(const FreshStore&) = delete;
  FreshStore& operator=(const FreshStore&) = delete;

  [[nodiscard]] const std::string& url() const { return url_; }

 private:
  void Remove() const {
    if (file_.empty()) return;
    std::error_code ignored;
    for (const char* end : {"", "-wal", "-shm"}) std::filesystem::remove(file_ + end, ignored);
  }

  std::optional<testing::PostgresDatabase> database_;
  std::string file_;
  std::string url_;
};

class Scenario final {
 public:
  Scenario(const FairRun& run, Misdeed misdeed, PinnedServer& server)
      : run_(run),
        misdeed_(misdeed),
        server_(server),
        others_(loop_, clock_, LinkTo(run.world, server)),
        watch_(server.ports().http, BadRuri(), misdeed) {}

  FairResult Run() {
    FairResult result{.misdeed = misdeed_};
    const auto robots = static_cast<std::size_t>(run_.flags.robots);
    const std::size_t open = others_.Connect(run_.world.identities, robots, kConnectWait);
    if (open < robots) {
      result.failure = fmt::format("{} of {} robots were welcomed", open, robots);
      return result;
    }
    others_.Drive(kWarmUp, [this] { return Turn(); });
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
    if (misdeed_ != Misdeed::kGateway) return spec;
    spec.units = {"gateway"};
    spec.uris = GatewayRobots(BadRuri());
    return spec;
  }

  static link::LinkOptions LinkTo(const World& world, const PinnedServer& server) {
    link::LinkOptions options;
    options.tls =
        *link::TlsClient::Create(world.folder.authority().certificate(), link::Alpn::kHttp2);
    options.address = *link::Resolve("127.0.0.1:" + std::to_string(server.ports().relay));
    return options;
  }

  /// False where nothing that follows would mean anything.
  bool Turn() {
    memory_ = std::max(memory_, server_.use().rss_bytes);
    const SteadyTime now = clock_.Steady();
    if (now - log_read_ > kReadLogEvery) {
      server_.ReadLog();
      log_read_ = now;
    }
    return !run_.stopped() && !server_.ended();
  }

  WindowFigures Measure(Watch::Window window) {
    watch_.Enter(window);
    memory_ = 0;
    const SteadyTime began = clock_.Steady();
    const synthetic::ProcessUse before = server_.use();
    const OthersTally tally =
        others_.Measure(std::chrono::seconds(run_.flags.seconds), [this] { return Turn(); });
    const double cpu = server_.use().Since(before).cpu_seconds;
    const double took = std::chrono::duration<double>(clock_.Steady() - began).count();
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
            .memory_mib = static_cast<double>(memory_) / kMiB,
            .scrapes = seen.scrapes,
            .scrapes_failed = seen.failed,
            .law_broken = seen.law_broken};
  }

  std::unique_ptr<testing::ServerProcess> StartBadRobot() const {
    const testing::UplinkdFolder& folder = run_.world.folder;
    const testing::KeyPair pair = folder.authority().Issue(BadSpec());
    folder.Write("bad.crt", pair.certificate);
    folder.Write("bad.key", pair.key);
    // It ends by itself, too, should nobody be left to end it.
    const auto most = std::chrono::seconds(run_.flags.seconds) + kBeginWait +
                      std::chrono::duration_cast<std::chrono::seconds>(Others::kAckPatience) +
                      kBadEndWait;
    return std::make_unique<testing::ServerProcess>(std::vector<std::string>{
        run_.bad_robot_bin, "--misdeed", NameOf(misdeed_), "--ruri", BadRuri(), "--folder",
        folder.Path(""), "--port", std::to_string(server_.ports().relay), "--seconds",
        std::to_string(most.count())});
  }

  void AwaitBadRobot(testing::ServerProcess& bad) {
    bool at_work = false;
    others_.Drive(kBeginWait, [&] {
      at_work = at_work || bad.WaitFor("at work", milliseconds(2));
      return !at_work && Turn();
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

  const FairRun& run_;
  const Misdeed misdeed_;
  PinnedServer& server_;
  const SystemClock clock_{};
  link::Loop loop_;
  Others others_;
  Watch watch_;
  std::uint64_t memory_ = 0;
  SteadyTime log_read_{};
};

}  // namespace

FairResult RunScenario(const FairRun& run, Misdeed misdeed) {
  run.say(fmt::format("{}: {}", NameOf(misdeed), AboutOf(misdeed)));
  const FreshStore store(run.world, run.flags);
  auto server =
      PinnedServer::Start(run.world, {.program = run.server_bin, .store_url = store.url()});
  if (!server.ok()) {
    return {.misdeed = misdeed, .failure = std::string(server.status().message())};
  }
  FairResult result = Scenario(run, misdeed, **server).Run();
  run.say("  the server: " + (*server)->Stop());
  return result;
}

}  // namespace uplink::bench
