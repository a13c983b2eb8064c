#pragma once

#include <memory>
#include <vector>

#include <absl/status/statusor.h>
#include <sys/types.h>

#include "schema/base/clock.h"
#include "server/config/address.h"
#include "server/config/networks.h"
#include "server/http/entrance.h"
#include "server/http/limits.h"
#include "server/http/listeners.h"
#include "server/http/probe.h"
#include "server/log/logger.h"
#include "server/loop/read_threads.h"

namespace boost::asio {
class io_context;
}  // namespace boost::asio

namespace uplink::http {

/// The threads on which requests are answered (HttpServer::Context).
inline constexpr loop::ThreadKind kMemoryThread{"http-memory", 0};
inline constexpr loop::ThreadKind kReadThread{"http-read", 0};
inline constexpr loop::ThreadKind kMetricsThread{"http-metrics", 0};
/// Scrapes of robots give way to the robots.
inline constexpr loop::ThreadKind kScrapeThread{"http-scrape", 10};
/// So do watches.
inline constexpr loop::ThreadKind kWatchThread{"http-watch", 10};
/// So do scrapes of /metrics that strangers may ask for.
inline constexpr loop::ThreadKind kMonitorThread{"http-monitor", 10};

class ServedTls;

/// An HTTP/1.1 listener: bounded connections (Places) with keep-alive on one event loop. One
/// address serves HTTP and, with Options::tls, HTTPS: the first byte of a connection tells them
/// apart.
///
/// Thread: made and destroyed by the loop's owner while the loop does not run.
class HttpServer final {
 public:
  struct Options {
    ListenerId listener = ListenerId::kHttp;
    config::ListenAddress address;
    ListenerLimits limits = kHttpLimits;
    /// Of a Unix socket.
    mode_t socket_mode = 0660;
    /// Null: no TLS. Outlives the listener.
    const ServedTls* tls = nullptr;
    /// Who may speak without TLS: http.plain_from. Of listen.http alone; listen.metrics has no TLS.
    std::vector<config::Network> plain_from = config::LoopbackNetworks();
  };
  struct Context {
    /// One thread runs it: the loop.
    boost::asio::io_context& io;
    const Entrance& entrance;
    /// What is in memory, and waits for the store a moment at most.
    loop::ReadThreads& memory;
    loop::ReadThreads& reads;
    /// Where our own scrapes are written. Takes one job per connection of the listener.
    loop::ReadThreads& metrics;
    /// Where the robots' scrapes are written; those of listen.http go ahead of others.
    loop::ReadThreads& scrapes;
    /// Where the changes of watches are written. Takes one job per connection of the listener.
    loop::ReadThreads& watches;
    HttpProbe& probe;
    const Clock& clock;
    /// At level debug each answer is a line.
    const log::Logger& logger;
  };

  /// Binds and listens; answers once the loop runs. What the context names must outlive the loop.
  ///
  /// A Unix socket that a server which is over has left is replaced; ours is removed at the end.
  ///
  /// Errors: kUnavailable naming key and address, if it cannot be bound.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<HttpServer>> Listen(const Context& context,
                                                                          const Options& options);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  /// The address with the port that was really bound. Any thread.
  [[nodiscard]] const config::ListenAddress& bound() const { return bound_; }

 private:
  class Listener;
  explicit HttpServer(std::shared_ptr<Listener> listener);
  std::shared_ptr<Listener> listener_;
  const config::ListenAddress bound_;
};

}  // namespace uplink::http
