#include "server/run/early_services.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <signal.h>

#include "server/config/address.h"
#include "server/http/limits.h"
#include "server/http/server.h"

namespace uplink::run {
namespace {

constexpr loop::ThreadKind kOwnReadThread{"store-read", 0};
constexpr const char* kTlsThread = "http-tls";

/// Of listen.http. On the machine its own clients share the places; beyond it a source has a
/// quarter, as on listen.metrics.
http::ListenerLimits HttpLimitsOf(const config::ListenAddress& address,
                                  const config::HttpConfig& http) {
  http::ListenerLimits limits = http::kHttpLimits;
  limits.connections_max = http.connections_max;
  if (!config::IsLoopback(address)) {
    limits.source_share = std::max<std::size_t>(http.connections_max / 4, 2);
  }
  return limits;
}

}  // namespace

EarlyServices::EarlyServices(Context context)
    : context_(std::move(context)),
      audit_(context_.logger),
      access_({context_.clock, context_.logger, context_.http, context_.tls, http_probe_, audit_}),
      entrance_(http::KnownHosts(context_.http.hosts),
                context_.http.hosts_cover_metrics ? http::Entrance::Covered::kDataAndScrapes
                                                  : http::Entrance::Covered::kData,
                &access_.guard()),
      stop_signal_(context_.logger, [this](int signal) { context_.greeting.TellStopped(signal); }),
      loop_(context_.logger) {
  memory_.emplace(http_probe_.reads_waiting, http_probe_.reads_refused, http::kMemoryThread);
  reads_.emplace(http_probe_.reads_waiting, http_probe_.reads_refused, http::kReadThread,
                 loop::JobBounds{.threads = context_.readers});
  own_reads_.emplace(http_probe_.reads_waiting, http_probe_.reads_refused, kOwnReadThread);
  // A connection has one job at most, which leaves with it if it gives way, so no scrape is
  // refused.
  metrics_.emplace(http_probe_.metrics_waiting, http_probe_.reads_refused, http::kMetricsThread,
                   loop::JobBounds{.waiting_max = context_.http.connections_max});
  // Those of listen.http go ahead.
  scrapes_.emplace(http_probe_.scrapes_waiting, rcan_probe_.refused_total, http::kScrapeThread,
                   loop::JobBounds{.waiting_max = http::kMetricsLimits.connections_max,
                                   .ahead_max = loop::kReadsWaitingMax});
  if (access_.tls() != nullptr) tls_loop_.emplace(context_.logger, kTlsThread);
  if (!config::IsSet(context_.listen.metrics)) return;
  monitor_.emplace(http_probe_.metrics_waiting, http_probe_.reads_refused, http::kMonitorThread,
                   loop::JobBounds{.waiting_max = http::kMetricsLimits.connections_max});
}

EarlyServices::~EarlyServices() {
  StopLoop();
  EndReaders();
}

absl::Status EarlyServices::Listen() {
  const auto listen = [this](loop::EventLoop& loop, loop::ReadThreads& metrics,
                             const http::HttpServer::Options& options) {
    return http::HttpServer::Listen({loop.io(), entrance_, *memory_, *reads_, metrics, *scrapes_,
                                     http_probe_, context_.clock, context_.logger},
                                    options);
  };
  auto http = listen(tls_loop_ ? *tls_loop_ : loop_, *metrics_,
                     {.listener = http::ListenerId::kHttp,
                      .address = context_.listen.http,
                      .limits = HttpLimitsOf(context_.listen.http, context_.http),
                      .socket_mode = config::ParseSocketMode(context_.http.socket_mode).value_or(0),
                      .tls = access_.tls(),
                      .plain_from = context_.http.plain_from});
  if (!http.ok()) return http.status();
  http_ = *std::move(http);
  if (!monitor_) return absl::OkStatus();
  auto monitoring =
      listen(loop_, *monitor_,
             {http::ListenerId::kMetrics, context_.listen.metrics, http::kMetricsLimits});
  if (!monitoring.ok()) return monitoring.status();
  monitoring_ = *std::move(monitoring);
  return absl::OkStatus();
}

absl::Status EarlyServices::Begin() {
  if (absl::Status opened = access_.Open(); !opened.ok()) return opened;
  if (absl::Status listens = Listen(); !listens.ok()) return listens;
  loop_.OnSignals({SIGTERM, SIGINT}, [this](int signal) { stop_signal_.OnSignal(signal); });
  loop_.OnSignals({SIGHUP}, [this](int) {
    reload_asked_ = !reload_;
    if (reload_) reload_();
  });
  loop_.Start();
  if (tls_loop_) tls_loop_->Start();
  context_.logger.Info("probes_answered", {{"http", config::ToText(http_address())},
                                           {"metrics", config::ToText(metrics_address())}});
  return absl::OkStatus();
}

void EarlyServices::Open(const http::Site& site) {
  stop_signal_.NoteStarted();
  entrance_.Open(site);
}

void EarlyServices::OnReload(std::function<void()> reload) {
  loop_.Post([this, reload = std::move(reload)]() mutable {
    reload_ = std::move(reload);
    if (std::exchange(reload_asked_, false)) reload_();
  });
}

void EarlyServices::Repeat(PeriodicWork work) {
  loop_.Post([this, work = std::move(work)]() mutable {
    DoPeriodically(
        [this](milliseconds interval, auto job) { loop_.Every(interval, std::move(job)); },
        std::move(work));
  });
}

void EarlyServices::EndReaders() {
  monitor_.reset();
  scrapes_.reset();
  metrics_.reset();
  memory_.reset();
  reads_.reset();
  own_reads_.reset();
}

config::ListenAddress EarlyServices::http_address() const { return http_->bound(); }

config::ListenAddress EarlyServices::metrics_address() const {
  return monitoring_ ? monitoring_->bound() : config::ListenAddress();
}

}  // namespace uplink::run
