#include "server/run/app.h"

#include <span>
#include <utility>

#include "metrics/ledger.h"
#include "server/config/address.h"
#include "server/fleet/fleet.h"
#include "server/fleet/robot_settings.h"
#include "server/identity/expiry.h"
#include "server/log/logger.h"
#include "server/robot/connection_reports.h"
#include "server/rpc/probe.h"
#include "server/run/broker_side.h"
#include "server/run/command_side.h"
#include "server/run/drain.h"
#include "server/run/early_services.h"
#include "server/run/fleet_side.h"
#include "server/run/followed_file.h"
#include "server/run/from_config.h"
#include "server/run/greeting.h"
#include "server/run/health_side.h"
#include "server/run/relay_side.h"
#include "server/run/reload.h"
#include "server/run/start.h"
#include "server/run/store_side.h"
#include "server/run/supervisor.h"
#include "server/run/uncrew_side.h"
#include "server/run/view_side.h"
#include "server/store/open.h"
#include "server/store/process_life.h"

namespace uplink::run {

class App::Impl {
 public:
  Impl(Options options, EarlyServices& early, SystemTime certificate_expiry, store::Stores stores)
      : options_(std::move(options)),
        early_(early),
        fleet_(options_.clock, options_.config.limits.robots_max,
               PresenceLimitsOf(options_.config.presence), TwinPresenceLimitsOf(options_.config),
               &options_.boot_clock),
        settings_(fleet::RobotSettingsMax(options_.config.limits.robots_max)),
        store_(ContextOfStore(), std::move(stores)),
        reports_({.clock = options_.clock,
                  .logger = options_.logger,
                  .sink = &store_.connections(),
                  .process = options_.process,
                  .seed = options_.random()}),
        uncrew_({options_.clock, options_.config, fleet_, store_.journals(), ledgers_, allowances_,
                 options_.random(), reports_}),
        relay_({options_.clock, options_.logger, options_.config, fleet_, store_.journals(),
                ledgers_, allowances_, store_.stores(), options_.version, early.OnReadsAhead(),
                options_.random(), reports_, early.access().denied(), uncrew_.Methods()}),
        broker_({options_.clock, options_.logger, options_.config, fleet_, store_.journals(),
                 ledgers_, store_.journal_limits(), *store_.stores().reader, store_.leases(),
                 options_.process, options_.random, allowances_, reports_},
                std::move(store_.stores().topic_leases)),
        health_({options_.clock, options_.logger, options_.config, fleet_, store_, relay_, broker_,
                 early.loop(), certificate_expiry, [this] { return view_.series_left_out(); },
                 [&early] { return early.access().facts(); }}),
        commands_({options_.clock, early.audit(), fleet_, store_.stores(), early.loop(),
                   [this] { return ReadAgain(); }, [this] { store_.WakeAccess(); }}),
        view_({options_.clock, options_.logger, options_.config, options_.version, fleet_, ledgers_,
               early, store_, uncrew_, relay_, broker_, health_, commands_.commands(), settings_,
               options_.random, in_effect_, rpc_probe_}),
        reload_(options_.config, {.read = options_.read_config,
                                  .allowances = allowances_,
                                  .logger = options_.logger,
                                  .in_effect = in_effect_,
                                  .look_at_files = [&early] { return early.access().Look(); },
                                  .took_over =
                                      [this, &early](const config::Config& running) {
                                        early.TakeOver(running.http);
                                        fleet_.entry().Follow(EntryRulesOf(running.identity));
                                        view_.Follow(running.view);
                                      }}) {
    fleet_.ShowFleets(options_.config.metrics.fleets_max);
    fleet_.entry().Set(EntryRulesOf(options_.config.identity), settings_);
    settings_.OnChange([this](std::span<const fleet::RobotSettings::Change> changes) {
      fleet_.OnSettings(changes);
    });
  }

  ~Impl() { Stop(); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  absl::Status Start() {
    return run::Start({.read_robots = [this] { store_.ReadRobots(); },
                       .start_writers = [this] { store_.StartWriters(); },
                       .listen_for_robots = [this] { return ListenForRobots(); },
                       .answer_http =
                           [this] {
                             view_.BeginWatches();
                             early_.Open(view_.site());
                             early_.OnReload(
                                 [this] { commands_.NoteReload(ReadAgain(), "SIGHUP"); });
                           },
                       .tell_ready = [this] { TellReady(); },
                       .begin_work =
                           [this] {
                             early_.Repeat(WorkToDo());
                             EndGreeting();
                           }});
  }

  int Run() {
    early_.stop_signal().Wait();
    Supervisor::NoteStopping();
    commands_.NoteStop();
    Drain(ContextOfDrain()).Run();
    // What the server's thread for it has not written any more.
    commands_.Flush();
    return early_.stop_signal().exit_code();
  }

 private:
  StoreSide::Context ContextOfStore() {
    return {.clock = options_.clock,
            .logger = options_.logger,
            .config = options_.config,
            .fleet = fleet_,
            .ledgers = ledgers_,
            .process = options_.process,
            .random = options_.random,
            .kernel_clock_synchronised = options_.kernel_clock_synchronised,
            .spatial_committed = [this] { relay_.OnSpatialCommitted(); },
            .reconnected = [this] { broker_.Reread(); },
            .shut_out = [this] { early_.EndAsFailed(); },
            .moved = [this](const journal::Moved& moved) { commands_.NoteMove(moved); },
            .denied = early_.access().denied(),
            .settings = settings_,
            .denied_changed =
                [this] {
                  relay_.LookAtDenied();
                  operators_.LookAtDenied();
                },
            .file_lists = [this] { return early_.access().lists().Look(); }};
  }

  Drain::Context ContextOfDrain() {
    return {
        .clock = options_.clock,
        .logger = options_.logger,
        .ledgers = ledgers_,
        .fleet = fleet_,
        .journals = store_.journals(),
        .monitor = health_.monitor(),
        .signal = early_.stop_signal(),
        .transport = relay_.DrainTransport(),
        .leave = [this] { return store_.leases().Leave() == store::LeaseRounds::Left::kToOthers; },
        .stop_adopting = [this] { store_.leases().StopAdopting(); },
        .drain_broker = [this] { broker_.BeginDrain(); },
        .leave_broker = [this] { broker_.EndDrain(); },
        .stop = [this] { Stop(); },
        .timeout = options_.config.drain.timeout};
  }

  absl::Status ListenForRobots() {
    if (absl::Status listens = relay_.Listen(); !listens.ok()) return listens;
    if (absl::Status listens = operators_.Listen(); !listens.ok()) return listens;
    const std::string name =
        config::ToText({.host = store::HostName(), .port = relay_.server().port()});
    reports_.SetServer(name);
    commands_.NoteStart(name, options_.version);
    health_.BeginListening();
    store_.StartRounds(relay_.server().port());
    relay_.StartForwarding();
    broker_.Start();
    return absl::OkStatus();
  }

  void TellReady() {
    options_.logger.Info("listening", {{"relay", config::ToText(relay_.Target().address)},
                                       {"http", config::ToText(early_.http_address())},
                                       {"metrics", config::ToText(early_.metrics_address())},
                                       {"fleet", config::ToText(operators_.address())},
                                       {"version", options_.version},
                                       {"robots", fleet_.size()}});
    options_.greeting.TellReady({.store = store::NameOf(options_.config.store),
                                 .robots = fleet_.size(),
                                 .robots_unread = store_.robots_unread(),
                                 .relay = relay_.Target().address,
                                 .http = early_.http_address(),
                                 .metrics = early_.metrics_address(),
                                 .fleet = operators_.address()});
    Supervisor::NoteReady();
  }

  admin::Reloaded ReadAgain() {
    config_file_.NoteRead();
    return reload_.Run();
  }

  /// Ends the greeting after the first round of the periodic work, whose info events belong to the
  /// start. A job that waits on the loop already posts that round; hence two posts.
  void EndGreeting() {
    loop::EventLoop& loop = early_.loop();
    loop.Post([this, &loop] { loop.Post([this] { options_.greeting.End(); }); });
  }

  [[nodiscard]] PeriodicWork WorkToDo() {
    PeriodicWork work;
    store_.AddWork(early_.OnReads(), work);
    health_.AddWork(work);
    view_.AddWork(work);
    commands_.AddWork(early_.OnReads(), work);
    work.look_at_drones = [this] { uncrew_.Round(); };
    work.look_at_access = [this] {
      static_cast<void>(early_.access().Look());
      operators_.Look();
      WarnOfUnnamed();
    };
    work.look_at_config = [this] {
      if (config_file_.Look()) commands_.NoteReload(reload_.Run(), "the file");
    };
    return work;
  }

  void WarnOfUnnamed() {
    if (const auto gateway = fleet_.entry().TakeUnnamed()) {
      options_.logger.Warn("gateway_unnamed",
                           {{"gateway", *gateway},
                            {"why",
                             "its certificate names no robots, so it speaks for any of its "
                             "fleet; from 1.0 on identity.gateways is \"named\""}});
    }
  }

  void Stop() {
    run::Stop({.stop_relay =
                   [this] {
                     operators_.Stop();
                     view_.EndWatches();
                     relay_.Shutdown();
                   },
               .stop_writers =
                   [this] {
                     broker_.Stop();
                     relay_.StopForwarding();
                     store_.Stop();
                   },
               .stop_loop = [this] { early_.StopLoop(); },
               .end_readers = [this] { early_.EndReaders(); }});
  }

  Options options_;
  EarlyServices& early_;
  ingest::Allowances allowances_{AllowanceOf(options_.config)};
  metrics::LedgerBook ledgers_;
  fleet::Fleet fleet_;
  fleet::RobotSettings settings_;
  StoreSide store_;
  robot::ConnectionReports reports_;
  UncrewSide uncrew_;
  RelaySide relay_;
  BrokerSide broker_;
  HealthSide health_;
  config::InEffect in_effect_{options_.config_file, options_.config, options_.places};
  CommandSide commands_;
  rpc::RpcProbe rpc_probe_;
  ViewSide view_;
  FleetSide operators_{{options_.logger, options_.config, early_, relay_, health_, view_.site(),
                        view_.watches(), rpc_probe_}};
  Reload reload_;
  FollowedFile config_file_{options_.config_file};
};

App::App(std::unique_ptr<EarlyServices> early, std::unique_ptr<Impl> impl)
    : early_(std::move(early)), impl_(std::move(impl)) {}
App::~App() = default;

absl::StatusOr<std::unique_ptr<App>> App::Start(Options options) {
  const config::Config& config = options.config;
  const auto expiry = identity::ExpiryOfFile(config.tls.certificate_file);
  if (!expiry.ok()) return expiry.status();
  auto early = std::make_unique<EarlyServices>(
      EarlyServices::Context{options.clock, options.logger, config.listen, config.http, config.tls,
                             config.identity, config.store.readers, options.greeting});
  if (absl::Status began = early->Begin(); !began.ok()) return began;
  options.logger.Info("store_opening", {{"store", store::NameOf(config.store)}});
  auto stores = store::OpenStores(config, options.process, options.clock.machine(), options.logger);
  if (!stores.ok()) return stores.status();
  auto impl = std::make_unique<Impl>(std::move(options), *early, *expiry, *std::move(stores));
  if (absl::Status started = impl->Start(); !started.ok()) return started;
  return std::unique_ptr<App>(new App(std::move(early), std::move(impl)));
}

int App::Run() { return impl_->Run(); }

}  // namespace uplink::run
