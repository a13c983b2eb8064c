#include "server/app.h"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <optional>
#include <semaphore>
#include <utility>

#include <fmt/ranges.h>
#include <signal.h>

#include "metrics/ledger.h"
#include "server/app_samples.h"
#include "server/fleet/fleet.h"
#include "server/health/monitor.h"
#include "server/health/presence_watch.h"
#include "server/health/process.h"
#include "server/http/read_thread.h"
#include "server/http/scrape.h"
#include "server/http/server.h"
#include "server/http/site.h"
#include "server/journal/journal.h"
#include "server/lifecycle/deadline.h"
#include "server/lifecycle/from_config.h"
#include "server/lifecycle/reload.h"
#include "server/loop/event_loop.h"
#include "server/loop/handshake_probe.h"
#include "server/opened.h"
#include "server/rcan/scrape.h"
#include "server/relay/server.h"
#include "server/store/store_side.h"
#include "server/view/queries.h"

namespace uplink {
namespace {

/// How often a drain looks whether the journal is empty.
constexpr milliseconds kIdleLook{10};
/// What the end of a drain has at least for what waits, however long the streams took.
constexpr std::chrono::seconds kLastWrites{2};
/// How often the store's last error is looked at, for the log.
constexpr std::chrono::seconds kStoreEvery{1};
/// How often a fleet that could not be read at the start is tried again.
constexpr std::chrono::seconds kSeedEvery{2};
}  // namespace

class App::Impl {
 public:
  Impl(Options options, Opened opened)
      : options_(std::move(options)),
        opened_(std::move(opened)),
        journal_limits_(lifecycle::JournalLimitsOf(options_.config.journal)),
        session_limits_(lifecycle::SessionLimitsOf(options_.config, options_.version)),
        fleet_(options_.clock, options_.config.limits.robots_max,
               lifecycle::PresenceLimitsOf(options_.config.presence)),
        store_(std::move(opened_.stores), PartsOfStore()),
        queries_({options_.clock, fleet_, store_.reader(), store_.journals(), ledgers_,
                  session_probe_, options_.version}),
        monitor_({options_.clock, fleet_, store_.journals(), journal_probe_, session_probe_,
                  journal_limits_, opened_.certificate_expiry, [this] { return store_.facts(); }}),
        watch_({options_.clock, fleet_, monitor_.liveness(), options_.logger, sweep_seconds_,
                session_limits_.session_idle}),
        scrape_({.clock = options_.clock,
                 .fleet = fleet_,
                 .journals = store_.journals(),
                 .journal_probe = journal_probe_,
                 .sessions = session_probe_,
                 .ledgers = ledgers_,
                 .monitor = monitor_,
                 .http = http_probe_,
                 .journal_limits = journal_limits_,
                 .http_connections_max = options_.config.http.connections_max,
                 .rcan = rcan_probe_,
                 .sweep_seconds = sweep_seconds_,
                 .rcan_series_max = options_.config.rcan.series_max,
                 .version = options_.version,
                 .store_facts = [this] { return store_.facts(); },
                 .add_relay =
                     [this](auto& page) {
                       AddRelaySamples(relay_probe_, session_probe_, options_.handshakes_failed,
                                       page);
                     }}),
        robots_scrape_({options_.clock, fleet_, options_.config.rcan, fault_counts_, rcan_probe_,
                        options_.logger}),
        site_(queries_, monitor_, scrape_, robots_scrape_),
        loop_(options_.logger) {}

  ~Impl() { Stop(); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  absl::Status Start() {
    fleet_.OnPresence(
        [this](const storage::RobotRef& robot, model::Presence presence, SystemTime at) {
          store_.journals().NotePresence(robot, presence, at);
        });
    if (absl::Status begun = store_.Begin(); !begun.ok()) return begun;
    reads_.emplace(http_probe_.reads_waiting, http_probe_.reads_refused, http::kReadThread);
    scrapes_.emplace(http_probe_.scrapes_waiting, rcan_probe_.refused_total, http::kScrapeThread);
    auto http = http::HttpServer::Listen(
        {loop_.io(), site_, *reads_, *scrapes_, http_probe_, options_.clock},
        {options_.config.listen.http, options_.config.http.connections_max});
    if (!http.ok()) return http.status();
    http_ = *std::move(http);
    store_.StartWriters();
    auto relay = relay::RelayServer::Start(
        lifecycle::RelayOptionsOf(options_.config, health::MemoryMax()),
        {options_.clock, fleet_, store_.journals(), session_probe_, relay_probe_, ledgers_,
         session_limits_, lifecycle::JudgeLimitsOf(options_.config.limits), &refusals_});
    if (!relay.ok()) return relay.status();
    relay_ = *std::move(relay);
    StartLoop();
    options_.logger.Info("listening", {{"relay", config::ToText(RelayAddress())},
                                       {"http", config::ToText(http_->bound())},
                                       {"version", options_.version},
                                       {"robots", fleet_.size()}});
    return absl::OkStatus();
  }

  void WaitForSignal() { stop_.acquire(); }

  void Drain() {
    const milliseconds timeout = options_.config.drain.timeout;
    const SteadyTime deadline = options_.clock.Steady() + timeout;
    options_.logger.Info("draining",
                         {{"streams", relay_->streams()}, {"timeout_ms", timeout.count()}});
    monitor_.BeginDrain();
    draining_.store(true);
    store_.journals().RequestCheckpoint();
    const lifecycle::Deadline last(timeout + kStopWait, [this] { EndUnfinished(); });
    relay_->Drain(timeout);
    if (!relay_->WaitForStreams(timeout)) {
      options_.logger.Warn("streams_left", {{"streams", relay_->streams()}});
    }
    // From now on nobody listens: the histories say so.
    for (const fleet::Robot* robot : fleet_.Sorted()) {
      if (robot->state.presence() == model::Presence::kUnknown) continue;
      store_.journals().NotePresence(robot->id(), model::Presence::kUnknown,
                                     options_.clock.System());
    }
    store_.journals().RequestCheckpoint();
    const SteadyTime end = std::max(deadline, options_.clock.Steady() + kLastWrites);
    while (!store_.journals().idle() && options_.clock.Steady() < end) {
      // Nothing releases it a second time: a second signal ends the process.
      static_cast<void>(stop_.try_acquire_for(kIdleLook));
    }
    Stop();
    const std::int64_t unsettled = ledgers_.Sum().uplinks.in_flight;
    if (unsettled == 0) {
      options_.logger.Info("stopped");
    } else {
      options_.logger.Warn("stopped_unsettled", {{"uplinks", unsettled}});
    }
  }

 private:
  store::StoreSide::Parts PartsOfStore() {
    return {.clock = options_.clock,
            .logger = options_.logger,
            .ledgers = ledgers_,
            .probe = journal_probe_,
            .fleet = fleet_,
            .process = options_.process,
            .random = options_.random,
            .limits = journal_limits_,
            .robots_max = options_.config.limits.robots_max,
            .checkpoint_every = options_.config.store.checkpoint};
  }

  void StartLoop() {
    loop_.Every(kSweepEvery, [this] {
      if (!draining_.load()) watch_.Sweep();  // whom it sends away is not heard, and not offline
    });
    loop_.Every(kCertificateEvery, [this] { LookAtCertificate(); });
    loop_.Every(kStoreEvery, [this] { store_.LookForErrors(); });
    loop_.Every(kSeedEvery, [this] { store_.ReadRobotsOn(OnReads()); });
    loop_.Every(rcan::kFaultCountsEvery, [this] {
      if (robots_scrape_.wanted()) fault_counts_.RefreshOn(OnReads(), fleet_, store_.reader());
    });
    loop_.Every(health::kHandshakeEvery, [this] {
      watch_.AskRelay([this](auto done) {
        loop::ProbeHandshake(loop_, RelayAddress(), health::kHandshakeWait, std::move(done));
      });
    });
    loop_.OnSignals({SIGTERM, SIGINT}, [this](int signal) { OnStopSignal(signal); });
    loop_.OnSignals({SIGHUP}, [this](int) { OnReloadSignal(); });
    loop_.Start();
  }

  /// To the thread that may wait for the store.
  std::function<bool(std::function<void()>)> OnReads() {
    return [this](auto job) { return reads_->TryPost(std::move(job)); };
  }

  void LookAtCertificate() {
    const relay::FilesLook look = relay_->RefreshFiles();
    if (!monitor_.NoteCertificate(look.expiry, look.status.ok())) return;
    if (look.status.ok()) {
      options_.logger.Info("certificate_fits_again", {});
    } else {
      options_.logger.Error("certificate_mismatch", {{"why", std::string(look.status.message())}});
    }
  }

  void OnStopSignal(int signal) {
    if (stopping_) {
      options_.logger.Warn("stopped_at_once", {{"signal", signal}});
      std::_Exit(1);
    }
    stopping_ = true;
    stop_.release();
  }

  void OnReloadSignal() {
    const config::LoadResult read = options_.read_config();
    for (const config::Problem& problem : read.problems) {
      options_.logger.Error("reload_refused", {{"problem", config::ToText(problem)}});
    }
    if (!read.ok()) return;
    const lifecycle::Reload reload = lifecycle::CompareConfigs(options_.config, *read.config);
    const log::Level after = lifecycle::LogLevelOf(read.config->log.level);
    // By whichever level lets the line through.
    options_.logger.SetLevel(std::min(lifecycle::LogLevelOf(options_.config.log.level), after));
    // Only the level is taken over, so that the next reload names the rest again.
    options_.config.log.level = read.config->log.level;
    options_.logger.Write(
        reload.needs_restart.empty() ? log::Level::kInfo : log::Level::kWarn, "reloaded",
        {{"log_level_changed", reload.log_level},
         {"needs_restart", fmt::format("{}", fmt::join(reload.needs_restart, ","))}});
    options_.logger.SetLevel(after);
  }

  /// The rest did not end in time: the process does, with what it has.
  void EndUnfinished() {
    options_.logger.Warn("stopped_unsettled", {{"uplinks", ledgers_.Sum().uplinks.in_flight}});
    std::_Exit(0);
  }

  void Stop() {
    if (relay_ != nullptr) relay_->Shutdown(kStopWait / 2);
    store_.StopWriters();
    loop_.Stop();
    scrapes_.reset();
    reads_.reset();
  }

  [[nodiscard]] config::ListenAddress RelayAddress() const {
    return {options_.config.listen.relay.host, relay_->port()};
  }

  Options options_;
  Opened opened_;
  const journal::JournalLimits journal_limits_;
  const session::SessionLimits session_limits_;
  metrics::LedgerBook ledgers_;
  log::RateLimited refusals_{options_.logger};
  session::SessionProbe session_probe_;
  journal::JournalProbe journal_probe_;
  relay::RelayProbe relay_probe_;
  http::HttpProbe http_probe_;
  rcan::RcanProbe rcan_probe_;
  metrics::LatencyDistribution sweep_seconds_{metrics::kLatencyBoundsSeconds};
  fleet::Fleet fleet_;
  store::StoreSide store_;
  view::Queries queries_;
  health::Monitor monitor_;
  health::PresenceWatch watch_;
  http::Scrape scrape_;
  rcan::FaultCounts fault_counts_{options_.clock};
  rcan::RobotScrape robots_scrape_;
  http::Site site_;
  std::atomic<bool> draining_{false};
  /// The io thread's own.
  bool stopping_ = false;
  std::binary_semaphore stop_{0};
  loop::EventLoop loop_;
  std::optional<http::ReadThread> reads_;
  std::optional<http::ReadThread> scrapes_;
  std::unique_ptr<http::HttpServer> http_;
  std::unique_ptr<relay::RelayServer> relay_;
};

App::App(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
App::~App() = default;

absl::StatusOr<std::unique_ptr<App>> App::Start(Options options) {
  absl::StatusOr<Opened> opened = Open(options.config, options.process, options.clock);
  if (!opened.ok()) return opened.status();
  auto impl = std::make_unique<Impl>(std::move(options), *std::move(opened));
  if (absl::Status started = impl->Start(); !started.ok()) return started;
  return std::unique_ptr<App>(new App(std::move(impl)));
}

void App::Run() {
  impl_->WaitForSignal();
  impl_->Drain();
}

}  // namespace uplink
