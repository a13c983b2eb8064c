#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include <absl/status/status.h>

#include "schema/base/clock.h"
#include "server/admin/audit_trail.h"
#include "server/config/config.h"
#include "server/http/entrance.h"
#include "server/http/probe.h"
#include "server/http/routes.h"
#include "server/log/logger.h"
#include "server/loop/event_loop.h"
#include "server/loop/one_at_a_time.h"
#include "server/loop/read_threads.h"
#include "server/rcan/probe.h"
#include "server/run/access_side.h"
#include "server/run/greeting.h"
#include "server/run/periodic.h"
#include "server/run/stop_signal.h"

namespace uplink::http {
class HttpServer;
}

namespace uplink::run {

/// What runs before there is a store: the event loop, signals, HTTP and the threads that answer it.
/// Until Open, HTTP answers that the server starts.
///
/// Thread: main. Parts of the server that use the loop or those threads must live until StopLoop
/// and EndReaders.
class EarlyServices final {
 public:
  /// The references outlive it.
  struct Context {
    const Clock& clock;
    log::Logger& logger;
    config::ListenConfig listen;
    config::HttpConfig http;
    config::TlsConfig tls;
    config::IdentityConfig identity;
    /// store.readers: questions that wait for the store side by side.
    std::size_t readers;
    Greeting& greeting;
  };
  explicit EarlyServices(Context context);
  ~EarlyServices();
  EarlyServices(const EarlyServices&) = delete;
  EarlyServices& operator=(const EarlyServices&) = delete;

  /// Listens for HTTP and hears signals from now on. Logs `probes_answered` with the addresses that
  /// were really bound. Errors: as HttpServer::Listen.
  [[nodiscard]] absl::Status Begin();
  /// The server has started: from now on the site answers, and a signal begins a drain.
  void Open(const http::Site& site);
  /// What SIGHUP does, on the loop's thread; at once if one came before. The job's parts live until
  /// StopLoop.
  void OnReload(std::function<void()> reload);

  /// What a reload brings to HTTP. On the loop's thread.
  void TakeOver(const config::HttpConfig& http) {
    entrance_.SetHosts(http::KnownHosts(http.hosts));
  }

  /// Begins the periodic work, on the loop's thread. Its parts live until StopLoop.
  void Repeat(PeriodicWork work);

  /// The server cannot go on: asks for an orderly stop, with exit code 1. Thread: any.
  void EndAsFailed() {
    loop_.Post([this] { stop_signal_.OnFailure(); });
  }

  void StopLoop() {
    if (tls_loop_) tls_loop_->Stop();
    loop_.Stop();
  }
  /// Ends the threads that answer HTTP or wait for the store, and drops the jobs that wait for
  /// them.
  void EndReaders();

  [[nodiscard]] loop::EventLoop& loop() { return loop_; }
  [[nodiscard]] StopSignal& stop_signal() { return stop_signal_; }
  /// Posts a job of the server's own to the one thread that waits for the store for it; false if it
  /// takes none now. Operators' questions have other threads, so none delays it. Until EndReaders.
  [[nodiscard]] loop::Post OnReads() {
    return [this](auto job) { return own_reads_->TryPost(std::move(job)).has_value(); };
  }
  /// The same, ahead of what others posted.
  [[nodiscard]] loop::Post OnReadsAhead() {
    return [this](auto job) { return own_reads_->TryPostAhead(std::move(job)).has_value(); };
  }
  /// What the audit tells, beside the commands. Any thread.
  [[nodiscard]] admin::AuditTrail& audit() { return audit_; }
  /// Posts a job that answers an operator to the threads of its lane, kMemory, kWatch or kRead;
  /// false if they take no more. Until EndReaders.
  [[nodiscard]] bool Post(http::Lane lane, std::function<void()> job) {
    auto& threads = lane == http::Lane::kMemory  ? memory_
                    : lane == http::Lane::kWatch ? watches_
                                                 : reads_;
    return threads->TryPost(std::move(job)).has_value();
  }
  /// Who may ask by HTTP. Look on the loop's thread.
  [[nodiscard]] AccessSide& access() { return access_; }
  [[nodiscard]] http::HttpProbe& http_probe() { return http_probe_; }
  [[nodiscard]] rcan::RcanProbe& rcan_probe() { return rcan_probe_; }
  /// The address that was really bound. After Begin.
  [[nodiscard]] config::ListenAddress http_address() const;
  /// The same of listen.metrics; without a host if it is not set.
  [[nodiscard]] config::ListenAddress metrics_address() const;

 private:
  [[nodiscard]] absl::Status Listen();

  const Context context_;
  http::HttpProbe http_probe_;
  rcan::RcanProbe rcan_probe_;
  admin::AuditTrail audit_;
  AccessSide access_;
  http::Entrance entrance_;
  StopSignal stop_signal_;
  // Confined to the loop's thread.
  std::function<void()> reload_;
  bool reload_asked_ = false;
  std::optional<loop::ReadThreads> memory_;
  /// Operators' questions; and what the server itself asks the store.
  std::optional<loop::ReadThreads> reads_;
  std::optional<loop::ReadThreads> own_reads_;
  std::optional<loop::ReadThreads> metrics_;
  std::optional<loop::ReadThreads> scrapes_;
  std::optional<loop::ReadThreads> watches_;
  /// Of listen.metrics, if that is set.
  std::optional<loop::ReadThreads> monitor_;
  loop::EventLoop loop_;
  /// Of listen.http, if that speaks TLS: strangers' handshakes delay no other work.
  std::optional<loop::EventLoop> tls_loop_;
  std::unique_ptr<http::HttpServer> http_;
  std::unique_ptr<http::HttpServer> monitoring_;
};

}  // namespace uplink::run
