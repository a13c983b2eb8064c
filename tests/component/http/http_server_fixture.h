#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "server/http/server.h"
#include "server/loop/event_loop.h"
#include "tests/support/kept_lines.h"
#include "tests/support/server_world.h"

namespace uplink::http {

/// A listener on a site with a fake store, as the server has it.
class HttpServerTest : public ::testing::Test {
 protected:
  static constexpr std::size_t kConnectionsMax = 16;

  HttpServerTest() {
    http::HttpProbe& probe = world_.http_probe;
    memory_.emplace(probe.reads_waiting, probe.reads_refused, kMemoryThread);
    reads_.emplace(probe.reads_waiting, probe.reads_refused, kReadThread);
    metrics_.emplace(probe.metrics_waiting, probe.reads_refused, kMetricsThread,
                     loop::JobBounds{.waiting_max = kConnectionsMax});
    scrapes_.emplace(probe.scrapes_waiting, world_.rcan_probe.refused_total, kScrapeThread);
    watches_.emplace(probe.watches_waiting, probe.reads_refused, kWatchThread);
    world_.to_store_thread = [this](auto job) {
      return reads_->TryPost(std::move(job)).has_value();
    };
    entrance_.Open(world_.site);
  }
  ~HttpServerTest() override {
    world_.reader.Release();
    loop_.Stop();
    scrapes_.reset();
    watches_.reset();
    metrics_.reset();
    memory_.reset();
    reads_.reset();
  }

  std::uint16_t Serve(const std::string& host = "127.0.0.1",
                      milliseconds request_wait = kHttpLimits.request_wait,
                      milliseconds idle_wait = kHttpLimits.idle_wait) {
    ListenerLimits limits = kHttpLimits;
    limits.connections_max = kConnectionsMax;
    limits.request_wait = request_wait;
    limits.idle_wait = idle_wait;
    server_ = Listen({ListenerId::kHttp, {host, 0}, limits});
    loop_.Start();
    return server_->bound().port;
  }

  std::unique_ptr<HttpServer> Listen(const HttpServer::Options& options) {
    auto server = TryListen(options);
    EXPECT_TRUE(server.ok()) << server.status();
    return *std::move(server);
  }

  absl::StatusOr<std::unique_ptr<HttpServer>> TryListen(const HttpServer::Options& options) {
    return HttpServer::Listen({loop_.io(), entrance_, *memory_, *reads_, *metrics_, *scrapes_,
                               *watches_, world_.http_probe, clock_, logger_},
                              options);
  }

  [[nodiscard]] const ConnectionProbe& Connections(ListenerId listener = ListenerId::kHttp) const {
    return world_.http_probe.connections[PlaceOf(listener)];
  }

  testing::ServerWorld world_;
  SystemClock clock_;
  /// The connections' own. Read after the loop's end.
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                      log::Level::kDebug};
  Entrance entrance_{KnownHosts({"uplink.example.org"})};
  loop::EventLoop loop_{world_.logger};
  std::optional<loop::ReadThreads> memory_;
  std::optional<loop::ReadThreads> reads_;
  std::optional<loop::ReadThreads> metrics_;
  std::optional<loop::ReadThreads> scrapes_;
  std::optional<loop::ReadThreads> watches_;
  std::unique_ptr<HttpServer> server_;
};

}  // namespace uplink::http
