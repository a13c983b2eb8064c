#include "server/run/app.h"

#include <utility>
#include <vector>

#include "metrics/cells.h"
#include "metrics/exposition.h"
#include "metrics/ledger.h"
#include "server/config/address.h"
#include "server/fleet/fleet.h"
#include "server/fleet/forgetting.h"
#include "server/fleet/live_budget.h"
#include "server/fleet/presence_watch.h"
#include "server/forward/forwarding.h"
#include "server/front/door/proxy_header.h"
#include "server/front/server.h"
#include "server/health/certificate_watch.h"
#include "server/health/monitor.h"
#include "server/health/process.h"
#include "server/http/site.h"
#include "server/identity/expiry.h"
#include "server/log/logger.h"
#include "server/loop/event_loop.h"
#include "server/loop/handshake_probe.h"
#include "server/rcan/scrape.h"
#include "server/run/broker_side.h"
#include "server/run/drain.h"
#include "server/run/from_config.h"
#include "server/run/groundwork.h"
#include "server/run/page_sources.h"
#include "server/run/periodic.h"
#include "server/run/reload.h"
#include "server/run/start.h"
#include "server/run/supervisor.h"
#include "server/store/clock_rounds.h"
#include "server/store/forget_rounds.h"
#include "server/store/lease_rounds.h"
#include "server/store/open.h"
#include "server/store/reject_reads.h"
#include "server/store/seed_rounds.h"
#include "server/store/space_rounds.h"
#include "server/store/watch.h"
#include "server/store/writers.h"
#include "server/view/queries.h"

namespace uplink::run {

class App::Impl {
 public:
  Impl(Options options, Groundwork& ground, SystemTime certificate_expiry, store::Stores stores)
      : options_(std::move(options)),
        ground_(ground),
        journal_limits_(JournalLimitsOf(options_.config.journal)),
        session_limits_(SessionLimitsOf(options_.config, options_.version)),
        fleet_(options_.clock, options_.config.limits.robots_max,
               PresenceLimitsOf(options_.config.presence), TwinPresenceLimitsOf(options_.config),
               &options_.boot_clock),
        stores_(std::move(stores)),
        writers_(stores_.writers, ContextOfWriters()),
        forgetting_({fleet_, options_.clock, options_.logger, options_.config.fleet.forget_after,
                     [this] { return stores_.clock->vouched(); },
                     [this](robot::Robot& robot) {
                       journals_.Leave({&robot, robot.id()});
                     }}),
        seed_rounds_({fleet_, journals_, *stores_.reader, options_.logger,
                      options_.config.limits.robots_max,
                      store::AdoptGraceOf(stores_, options_.config.presence),
                      [this](SystemTime heard_at) { return forgetting_.IsForgotten(heard_at); }}),
        leases_(std::move(stores_.leases),
                {fleet_, journals_, options_.clock, options_.logger, lease_probe_, options_.process,
                 options_.config.presence, store::IsGone,
                 [this](SystemTime heard_at) { return forgetting_.IsForgotten(heard_at); },
                 [this] { ground_.EndAsFailed(); }}),
        forget_rounds_({fleet_, journals_, options_.clock, options_.logger, *stores_.forget,
                        options_.process, !config::IsPostgres(options_.config.store),
                        store::RowsRuleOf(options_.config), *stores_.clock}),
        clock_rounds_({options_.clock, *stores_.marks, *stores_.clock, options_.logger,
                       options_.kernel_clock_synchronised}),
        space_rounds_({fleet_, options_.clock, options_.logger, stores_.space,
                       options_.config.store.free_min}),
        store_watch_({.facts = stores_.facts,
                      .retention = [this] { return journals_.retain_error(); },
                      .checkpoints = [this] { return journals_.checkpoint_error(); },
                      .store = [this] { return journals_.last_error(); },
                      .went_back = [this] { return journals_.TakeWentBack(); }},
                     options_.logger),
        queries_({options_.clock, fleet_, *stores_.reader, journals_, ledgers_,
                  session_probe_.streams, options_.version, ground_.OnReads(),
                  [this] { return !seed_rounds_.done(); }, &broker_side_.twins(),
                  [this] { return broker_side_.status(); }}),
        monitor_({options_.clock, fleet_, journals_, journal_probe_, session_probe_,
                  journal_limits_, certificate_expiry, stores_.facts,
                  [this] { return lease_probe_.failing.value() != 0; },
                  [this] { return !seed_rounds_.done(); }, stores_.clock.get(),
                  [this] { return space_rounds_.view().state != store::SpaceState::kEnough; },
                  [this] { return forwarding_.incomplete(); },
                  [this] { return live_budget_.over(); }, [this] { return broker_side_.facts(); },
                  [this] { return robots_scrape_.full(); }}),
        certificate_watch_(monitor_, options_.logger),
        watch_({options_.clock, fleet_, monitor_.liveness(), options_.logger, sweep_seconds_,
                session_limits_.session_idle, [this] { return leases_.OthersUnseen(); },
                [this] { return broker_side_.hearing(); }}),
        page_sources_(PageSourcesOf({options_.clock,
                                     options_.version,
                                     ledgers_,
                                     session_probe_,
                                     fleet_,
                                     live_budget_,
                                     sweep_seconds_,
                                     journals_,
                                     journal_limits_,
                                     journal_probe_,
                                     stores_,
                                     space_rounds_,
                                     lease_probe_,
                                     forwarding_,
                                     ground_.http_probe(),
                                     options_.config.http.connections_max,
                                     rcan_probe_,
                                     options_.config.rcan.series_max,
                                     monitor_,
                                     relay_probe_,
                                     broker_side_,
                                     options_.logger})),
        robots_scrape_({options_.clock, fleet_, options_.config.rcan, fault_counts_, rcan_probe_,
                        options_.logger, rcan::NameHash::Draw(options_.random),
                        &broker_side_.twins()}),
        site_({queries_, monitor_,
               [this](auto format) { return metrics::PageText(page_sources_, format); },
               robots_scrape_, options_.logger}),
        reload_(options_.config, {options_.read_config, allowances_, options_.logger}) {}

  ~Impl() { Stop(); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  absl::Status Start() {
    leases_.SetPort(options_.config.listen.relay.port);
    return run::Start({.read_robots = [this] { return ReadRobots(); },
                       .start_writers = [this] { writers_.Start(); },
                       .listen_for_robots = [this] { return ListenForRobots(); },
                       .answer_http =
                           [this] {
                             ground_.Open(site_);
                             ground_.OnReload([this] { reload_.Run(); });
                           },
                       .tell_ready = [this] { TellReady(); },
                       .begin_work = [this] { ground_.Repeat(WorkToDo()); }});
  }

  int Run() {
    ground_.stop_signal().Wait();
    Supervisor::NoteStopping();
    Drain(ContextOfDrain()).Run();
    return ground_.stop_signal().exit_code();
  }

 private:
  store::Writers::Context ContextOfWriters() {
    return {.clock = options_.clock,
            .ledgers = ledgers_,
            .probe = journal_probe_,
            .fleet = fleet_,
            .process = options_.process,
            .random = options_.random,
            .limits = journal_limits_,
            .spatial_committed = [this] { forwarding_.Wake(); },
            .store_reconnected = [this] { broker_side_.Reread(); },
            .checkpoint_every = options_.config.store.checkpoint,
            .logger = &options_.logger};
  }

  Drain::Context ContextOfDrain() {
    return {.clock = options_.clock,
            .logger = options_.logger,
            .ledgers = ledgers_,
            .fleet = fleet_,
            .journals = journals_,
            .monitor = monitor_,
            .signal = ground_.stop_signal(),
            .transport = {.streams = [this] { return relay_->streams(); },
                          .drain = [this](milliseconds wait) { relay_->Drain(wait); },
                          .wait_for_streams =
                              [this](milliseconds wait) { return relay_->WaitForStreams(wait); }},
            .leave = [this] { return leases_.Leave() == store::LeaseRounds::Left::kToOthers; },
            .stop_adopting = [this] { leases_.StopAdopting(); },
            .drain_broker = [this] { broker_side_.BeginDrain(); },
            .leave_broker = [this] { broker_side_.EndDrain(); },
            .stop = [this] { Stop(); },
            .timeout = options_.config.drain.timeout};
  }

  absl::Status ReadRobots() {
    fleet_.OnPresence([this](const storage::RobotRef& robot, model::Presence presence,
                             SystemTime at) { journals_.NotePresence(robot, presence, at); });
    store_watch_.LookAtFacts();
    if (stores_.away.ok()) clock_rounds_.Round();
    seed_rounds_.Begin(stores_.away);
    if (stores_.away.ok()) leases_.Round();
    return absl::OkStatus();
  }

  absl::Status ListenForRobots() {
    auto relay = front::FrontServer::Start(
        RelayOptionsOf(options_.config, health::MemoryMax()),
        {options_.clock, fleet_, journals_, session_probe_, relay_probe_, ledgers_, session_limits_,
         JudgeLimitsOf(options_.config.limits), allowances_, rejects_, *stores_.clock,
         &forwarding_.source(), &options_.logger});
    if (!relay.ok()) return relay.status();
    relay_ = *std::move(relay);
    fleet_.BeginListening();
    monitor_.liveness().BeginListening();
    leases_.SetPort(relay_->port());
    leases_.Start();
    forwarding_.Start();
    broker_side_.Start();
    forget_rounds_.Start();
    return absl::OkStatus();
  }

  void TellReady() {
    options_.logger.Info("listening", {{"relay", config::ToText(RelayTarget().address)},
                                       {"http", config::ToText(ground_.http_address())},
                                       {"version", options_.version},
                                       {"robots", fleet_.size()}});
    Supervisor::NoteReady();
  }

  [[nodiscard]] PeriodicWork WorkToDo() {
    PeriodicWork work;
    work.sweep = [this] {
      if (monitor_.draining()) return;  // whom it sends away is not heard, and not offline
      watch_.Sweep();
      live_budget_.Round();
      forgetting_.Round();
    };
    work.look_at_certificate = [this] {
      const transport::FilesLook look = relay_->RefreshFiles();
      certificate_watch_.OnLook(look.served, look.status);
    };
    work.look_at_store = [this] { store_watch_.Look(); };
    work.read_robots = [this] { seed_rounds_.ReadOn(ground_.OnReads()); };
    work.ask_for_snapshot = [this] { stores_.snapshot->AskOn(ground_.OnReads()); };
    work.look_at_space = [this] { space_rounds_.LookOn(ground_.OnReads()); };
    work.look_at_clock = [this] { clock_rounds_.LookOn(ground_.OnReads()); };
    work.count_faults = [this] {
      robots_scrape_.CountFaultsOn(ground_.OnReads(), *stores_.reader);
    };
    work.ask_relay = [this] {
      watch_.AskRelay([this](auto done) {
        loop::ProbeHandshake(loop_, RelayTarget(), fleet::kHandshakeWait, std::move(done));
      });
    };
    work.feed_watchdog = [this] { watchdog_.Beat(); };
    return work;
  }

  void Stop() {
    StopSteps steps;
    steps.stop_relay = [this] {
      if (relay_ != nullptr) relay_->Shutdown();
    };
    steps.stop_writers = [this] {
      broker_side_.Stop();
      leases_.Stop();
      forwarding_.Stop();
      forget_rounds_.Stop();
      writers_.Stop();
    };
    steps.stop_loop = [this] { ground_.StopLoop(); };
    steps.end_readers = [this] { ground_.EndReaders(); };
    run::Stop(steps);
  }

  [[nodiscard]] loop::ProbeTarget RelayTarget() {
    const config::ListenConfig& own = options_.config.listen;
    return {{own.relay.host, relay_->port()},
            own.proxy_protocol_from,
            std::string(front::kLocalProxyHeader),
            &relay_probe_.own_port};
  }

  Options options_;
  Groundwork& ground_;
  loop::EventLoop& loop_ = ground_.loop();
  rcan::RcanProbe& rcan_probe_ = ground_.rcan_probe();
  const journal::JournalLimits journal_limits_;
  const session::SessionLimits session_limits_;
  ingest::Allowances allowances_{AllowanceOf(options_.config)};
  metrics::LedgerBook ledgers_;
  session::SessionProbe session_probe_;
  journal::JournalProbe journal_probe_;
  transport::RelayProbe relay_probe_;
  store::LeaseProbe lease_probe_;
  metrics::LatencyDistribution sweep_seconds_{metrics::kLatencyBoundsSeconds};
  fleet::Fleet fleet_;
  store::Stores stores_;
  forward::Forwarding forwarding_{{options_.clock, options_.logger, *stores_.shared, *stores_.clock,
                                   options_.random(), stores_.change_signal.get()}};
  store::RejectReads rejects_{*stores_.reader, ground_.OnReadsAhead()};
  store::Writers writers_;
  const journal::Shards& journals_ = writers_.journals();
  fleet::Forgetting forgetting_;
  store::SeedRounds seed_rounds_;
  store::LeaseRounds leases_;
  BrokerSide broker_side_{
      {options_.clock, options_.logger, options_.config, fleet_, journals_, ledgers_,
       journal_limits_, *stores_.reader, leases_, options_.process, options_.random, allowances_},
      std::move(stores_.topic_leases)};
  fleet::LiveBudget live_budget_{{options_.clock, fleet_, broker_side_.twins(), options_.logger,
                                  LiveBytesMaxOf(options_.config.limits, health::MemoryMax())}};
  store::ForgetRounds forget_rounds_;
  store::ClockRounds clock_rounds_;
  store::SpaceRounds space_rounds_;
  store::Watch store_watch_;
  view::Queries queries_;
  health::Monitor monitor_;
  health::CertificateWatch certificate_watch_;
  fleet::PresenceWatch watch_;
  const Watchdog watchdog_{{.alive = [this] { return monitor_.liveness().alive(); }}};
  const std::vector<metrics::PageSource> page_sources_;
  rcan::FaultCounts fault_counts_{options_.clock};
  rcan::RobotScrape robots_scrape_;
  http::Site site_;
  Reload reload_;
  std::unique_ptr<front::FrontServer> relay_;
};

App::App(std::unique_ptr<Groundwork> ground, std::unique_ptr<Impl> impl)
    : ground_(std::move(ground)), impl_(std::move(impl)) {}
App::~App() = default;

absl::StatusOr<std::unique_ptr<App>> App::Start(Options options) {
  const config::Config& config = options.config;
  const auto expiry = identity::ExpiryOfFile(config.tls.certificate_file);
  if (!expiry.ok()) return expiry.status();
  auto ground = std::make_unique<Groundwork>(
      Groundwork::Context{options.clock, options.logger, config.listen.http, config.http});
  if (absl::Status began = ground->Begin(); !began.ok()) return began;
  options.logger.Info("store_opening", {{"store", store::NameOf(config.store)}});
  auto stores = store::OpenStores(config, options.process, options.clock.machine(), options.logger);
  if (!stores.ok()) return stores.status();
  auto impl = std::make_unique<Impl>(std::move(options), *ground, *expiry, *std::move(stores));
  if (absl::Status started = impl->Start(); !started.ok()) return started;
  return std::unique_ptr<App>(new App(std::move(ground), std::move(impl)));
}

int App::Run() { return impl_->Run(); }

}  // namespace uplink::run
